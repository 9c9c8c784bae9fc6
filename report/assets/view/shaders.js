// Programs of the graphics card (GLSL ES 3.00).

// Solids, lit from above and from behind the eye. Opposite quarters about z are a little darker, so that one
// sees a round body turn; what is not to scale is hatched.
const SOLID_VERTEX = `#version 300 es
uniform mat4 to_clip;
uniform mat3 turn;
uniform vec3 size;
uniform vec3 centre;
in vec3 position;
in vec3 normal;
out vec3 facing;
out vec2 quarter;
void main() {
  facing = turn * (normal / size);
  quarter = position.xy;
  gl_Position = to_clip * vec4(centre + turn * (size * position), 1.0);
}`;

const SOLID_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 colour;
uniform vec3 to_eye;
uniform bool hatched;
uniform bool quartered;
in vec3 facing;
in vec2 quarter;
out vec4 shown;
void main() {
  vec3 outward = normalize(facing);
  float light = 0.62 + 0.18 * outward.z + 0.3 * max(dot(outward, to_eye), 0.0);
  if (quartered && quarter.x * quarter.y > 0.0) light *= 0.86;
  vec3 own = colour.rgb;
  if (hatched && mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) < 3.0) own = mix(own, vec3(1.0), 0.7);
  shown = vec4(min(own * light, 1.0), colour.a);
}`;

// Lines as wide as said in pixels, with round ends: a quad on the screen for each, its ends brought before
// the eye first. A line without length is a dot.
const LINE_VERTEX = `#version 300 es
uniform mat4 to_clip;
uniform vec2 pixels;
uniform float nearest;
uniform float forward;
in vec3 from;
in vec3 to;
in vec4 colour;
in vec2 look;
out vec4 tint;
out vec2 place;
flat out vec3 stroke;
void main() {
  vec4 a = to_clip * vec4(from, 1.0);
  vec4 b = to_clip * vec4(to, 1.0);
  if (max(a.w, b.w) <= nearest) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  vec2 start = a.xy / a.w * pixels * 0.5;
  vec2 along = b.xy / b.w * pixels * 0.5 - start;
  float span = length(along);
  vec2 way = span > 1e-4 ? along / span : vec2(1.0, 0.0);
  float far_end = float(gl_VertexID & 1);
  float side = float(gl_VertexID >> 1) * 2.0 - 1.0;
  float margin = 0.5 * look.x + 1.0;
  place = vec2(far_end * span + (2.0 * far_end - 1.0) * margin, side * margin);
  vec2 at = start + way * place.x + vec2(-way.y, way.x) * place.y;
  float depth = mix(a.z / a.w, b.z / b.w, far_end) - forward;
  gl_Position = vec4(at / (pixels * 0.5), depth, 1.0);
  tint = colour;
  stroke = vec3(span, 0.5 * look.x, look.y);
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in vec4 tint;
in vec2 place;
flat in vec3 stroke;
out vec4 shown;
void main() {
  if (stroke.z > 0.0 && mod(place.x, 2.0 * stroke.z) > stroke.z) discard;
  float beyond = place.x - clamp(place.x, 0.0, stroke.x);
  float cover = clamp(stroke.y + 0.5 - length(vec2(beyond, place.y)), 0.0, 1.0);
  if (cover <= 0.02) discard;
  shown = vec4(tint.rgb, tint.a * cover);
}`;
