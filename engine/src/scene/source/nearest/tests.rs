use super::*;

#[test]
fn the_nearest_name_is_found() {
    let fields = [
        "mass_kg",
        "inertia",
        "length_m",
        "output_every_s",
        "density_kg_m3",
        "drag",
    ];
    for (given, meant) in [
        ("mas_kg", Some("mass_kg")),
        ("Mass_Kg", Some("mass_kg")),
        ("inertai", Some("inertia")),
        ("mass", Some("mass_kg")),
        ("length", Some("length_m")),
        ("density", Some("density_kg_m3")),
        ("output", Some("output_every_s")),
        ("Drag", Some("drag")),
        ("darg", Some("drag")),
        ("colour", None),
        ("x", None),
        ("", None),
    ] {
        assert_eq!(nearest(given, fields), meant, "{given}");
    }
    assert_eq!(nearest("abc", []), None);
    assert_eq!(nearest("from", ["from_here", "from_there"]), None);
}

#[test]
fn a_name_lacks_its_unit_only_before_a_unit() {
    assert!(lacks_unit("mass", "mass_kg"));
    assert!(lacks_unit("density", "density_kg_m3"));
    assert!(lacks_unit("velocity", "velocity_m_s"));
    assert!(!lacks_unit("output", "output_every_s"));
    assert!(!lacks_unit("mass", "massive_kg"));
    assert!(!lacks_unit("mass_kg", "mass_kg"));
    assert!(!lacks_unit("", "_kg"));
}
