// Forward dynamics of a hanging chain in Pinocchio: nanoseconds per joint, and what is left over
// when its accelerations are put back into the equations of motion.
//
//     pinocchio_chain time N RADIUS_M CPU_SECONDS   prints  pinocchio,N,ns_per_joint
//     pinocchio_chain residual N RADIUS_M POSES     prints  residual,N,double,extended,acceleration
//
// See README.md beside this file.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>

#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace pin = pinocchio;

const double GRAVITY = 8.87, LENGTH = 10.0, LINK_MASS = 0.05, TIP_MASS = 10.0;
const double LARGEST_TILT = 0.3, RATE = 0.1;

template <typename S> using Model = pin::ModelTpl<S, 0, pin::JointCollectionDefaultTpl>;
template <typename S> using Data = pin::DataTpl<S, 0, pin::JointCollectionDefaultTpl>;
template <typename S> using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

// Pinocchio's joint turns about the rod's axis too, so the rod needs a radius.
template <typename S> Model<S> chain(int n, double rod_radius) {
  typedef Eigen::Matrix<S, 3, 1> Vector3;
  typedef Eigen::Matrix<S, 3, 3> Matrix3;
  const S mass = S(LINK_MASS), length = S(LENGTH), radius = S(rod_radius);
  const S across = mass * (length * length / 12 + radius * radius / 4);
  const S along = mass * radius * radius / 2;
  const Matrix3 about_centre = Vector3(across, across, along).asDiagonal();
  Model<S> model;
  model.gravity.linear(Vector3(0, 0, -S(GRAVITY)));
  pin::JointIndex last = 0;
  for (int i = 0; i < n; ++i) {
    pin::SE3Tpl<S, 0> at = pin::SE3Tpl<S, 0>::Identity();
    if (i > 0)
      at.translation(Vector3(0, 0, -length));
    last = model.addJoint(last, pin::JointModelSphericalTpl<S, 0>(), at, std::to_string(i));
    model.appendBodyToJoint(last, pin::InertiaTpl<S, 0>(mass, Vector3(0, 0, -length / 2), about_centre));
  }
  model.appendBodyToJoint(last, pin::InertiaTpl<S, 0>(S(TIP_MASS), Vector3(0, 0, -length), Matrix3::Zero()));
  return model;
}

// Pinocchio's own Data(model) makes arrays of order nv^2 and nv^3, none of which aba() or rnea()
// touches: 0.9 TB at 1000 spherical joints. So this makes those of an empty model and enlarges
// what the two functions use.
template <typename S> Data<S> small_data(const Model<S> &model) {
  Data<S> data((Model<S>()));
  const std::size_t n = model.joints.size();
  data.joints.clear();
  for (const auto &joint : model.joints)
    data.joints.push_back(pin::CreateJointData<S, 0, pin::JointCollectionDefaultTpl>::run(joint));
  data.liMi.assign(n, Data<S>::SE3::Identity());
  data.v.assign(n, Data<S>::Motion::Zero());
  data.a_gf.assign(n, Data<S>::Motion::Zero());
  data.f.assign(n, Data<S>::Force::Zero());
  data.h.assign(n, Data<S>::Force::Zero());
  data.Yaba.assign(n, Data<S>::Inertia::Matrix6::Zero());
  data.u.setZero(model.nv);
  data.ddq.setZero(model.nv);
  data.tau.setZero(model.nv);
  return data;
}

struct State {
  Vector<double> q, v;
};

// Every link tilted from the vertical by up to LARGEST_TILT towards anywhere and turning across
// itself at up to RATE about each axis.
State random_state(int n, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  auto uniform = [&](double low, double high) {
    return low + (high - low) * std::ldexp(double(generator() >> 11), -53);
  };
  State state{Vector<double>(4 * n), Vector<double>(3 * n)};
  Eigen::Quaterniond parent = Eigen::Quaterniond::Identity();
  Eigen::Vector3d parent_rate = Eigen::Vector3d::Zero();
  for (int i = 0; i < n; ++i) {
    const double heading = uniform(-M_PI, M_PI), tilt = uniform(0.0, LARGEST_TILT);
    const Eigen::Vector3d axis(std::cos(heading), std::sin(heading), 0);
    const Eigen::Quaterniond attitude(Eigen::AngleAxisd(tilt, axis));
    const double across_x = uniform(-RATE, RATE), across_y = uniform(-RATE, RATE);
    const Eigen::Vector3d rate = attitude * Eigen::Vector3d(across_x, across_y, 0);
    state.q.segment<4>(4 * i) = (parent.conjugate() * attitude).normalized().coeffs();
    state.v.segment<3>(3 * i) = attitude.conjugate() * (rate - parent_rate);
    parent = attitude;
    parent_rate = rate;
  }
  return state;
}

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// The enlarged Data must give what Pinocchio's own gives.
void check_data(double radius) {
  const int n = 12;
  const Model<double> model = chain<double>(n, radius);
  Data<double> own(model), small = small_data(model);
  const State s = random_state(n, 1);
  const Vector<double> torque = Vector<double>::Constant(model.nv, 0.5);
  const Vector<double> a = pin::aba(model, own, s.q, s.v, torque);
  const Vector<double> b = pin::aba(model, small, s.q, s.v, torque);
  const Vector<double> c = pin::rnea(model, own, s.q, s.v, a);
  const Vector<double> d = pin::rnea(model, small, s.q, s.v, a);
  if (a != b || c != d || !a.allFinite()) {
    std::fprintf(stderr, "the enlarged Data does not give what Pinocchio's own gives\n");
    std::exit(1);
  }
}

void time_chain(int n, double radius, double seconds) {
  const Model<double> model = chain<double>(n, radius);
  Data<double> data = small_data(model);
  const State s = random_state(n, 1);
  const Vector<double> torque = Vector<double>::Zero(model.nv);
  // batches of about 5 ms, the least of which is kept
  const int calls = std::max(1, 5000000 / (300 * n));
  double least = INFINITY, sum = 0;
  const double end = cpu_seconds() + seconds;
  do {
    const double before = cpu_seconds();
    for (int i = 0; i < calls; ++i)
      sum += pin::aba(model, data, s.q, s.v, torque)[0];
    least = std::min(least, (cpu_seconds() - before) / calls);
  } while (cpu_seconds() < end);
  volatile double used = sum;
  (void)used;
  std::printf("pinocchio,%d,%.4g\n", n, least * 1e9 / n);
}

// The largest magnitude; not a number as soon as one is none.
template <typename S> double largest(const Vector<S> &values) {
  double worst = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double x = double(std::abs(values[i]));
    worst = std::isnan(worst) || x <= worst ? worst : x;
  }
  return worst;
}

// The largest torque rnea(q, v, aba(q, v, 0)), which should be zero, over total mass * gravity * link
// length, with rnea in double and in extended precision; and the largest difference of an
// acceleration from those of aba in extended precision, over the largest of those.
void residual(int n, double radius, int poses) {
  typedef long double Wide;
  const Model<double> model = chain<double>(n, radius);
  const Model<Wide> wide_model = chain<Wide>(n, radius);
  Data<double> data = small_data(model);
  Data<Wide> wide_data = small_data(wide_model);
  const Vector<double> torque = Vector<double>::Zero(model.nv);
  const double unit = (n * LINK_MASS + TIP_MASS) * GRAVITY * LENGTH;
  Vector<double> of_double(poses), of_wide(poses), of_acceleration(poses);
  for (int k = 0; k < poses; ++k) {
    const State s = random_state(n, 1 + k);
    const Vector<Wide> q = s.q.cast<Wide>(), v = s.v.cast<Wide>();
    const Vector<double> a = pin::aba(model, data, s.q, s.v, torque);
    of_double[k] = largest<double>(pin::rnea(model, data, s.q, s.v, a)) / unit;
    const Vector<Wide> wide_a = a.cast<Wide>();
    of_wide[k] = largest<Wide>(pin::rnea(wide_model, wide_data, q, v, wide_a)) / unit;
    const Vector<Wide> wide_torque = torque.cast<Wide>();
    const Vector<Wide> exact = pin::aba(wide_model, wide_data, q, v, wide_torque);
    of_acceleration[k] = largest<Wide>(wide_a - exact) / largest<Wide>(exact);
  }
  std::printf("residual,%d,%.2e,%.2e,%.2e\n", n, largest<double>(of_double), largest<double>(of_wide),
              largest<double>(of_acceleration));
}

int main(int count, char **arguments) {
  const std::string what = count == 5 ? arguments[1] : "";
  const int n = count == 5 ? std::atoi(arguments[2]) : 0;
  const double radius = count == 5 ? std::atof(arguments[3]) : 0;
  const double amount = count == 5 ? std::atof(arguments[4]) : 0;
  if (n < 1 || !(radius > 0) || !(amount > 0) || (what != "time" && what != "residual")) {
    std::fprintf(stderr, "pinocchio_chain time N RADIUS_M CPU_SECONDS\n"
                         "pinocchio_chain residual N RADIUS_M POSES\n");
    return 2;
  }
  check_data(radius);
  if (what == "time")
    time_chain(n, radius, amount);
  else
    residual(n, radius, std::max(1, int(amount)));
  return 0;
}
