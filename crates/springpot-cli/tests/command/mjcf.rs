//! Robots from MJCF files as a user meets them.

use crate::support::Place;

/// A pendulum on a cart with a spring, and a ball that falls.
const CART: &str = r#"<mujoco model="cart">
  <option gravity="0 0 -3.7"/>
  <worldbody>
    <body name="cart" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0" ref="0.2" stiffness="30" springref="0.3" damping="0.5"/>
      <geom type="box" size="0.2 0.1 0.1" mass="2"/>
      <body name="pole">
        <joint name="hinge" axis="0 1 0" pos="0 0 0.05" range="-90 90"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.6" mass="0.5"/>
      </body>
    </body>
    <body name="ball" pos="1 0 2" euler="0 0 30">
      <freejoint name="free"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3" mass="1"/>
    </body>
  </worldbody>
  <equality><joint joint1="slide" joint2="hinge"/></equality>
</mujoco>
"#;

fn place() -> Place {
    let place = Place::new();
    place.write("cart.xml", CART);
    place
}

#[test]
fn a_file_is_looked_at_and_begun_with() {
    let place = place();
    let said = place.done(&["info", "cart.xml"]).stdout;
    assert!(said.contains("slide") && said.contains("hinge") && said.contains("free"), "{said}");
    place.done(&["init", "cart.xml", "--forward", "--out", "cart.toml"]);
    let text = place.read("cart.toml");
    for line in ["mjcf = \"cart.xml\"", "slide = 0.2", "free = { x = 1, y = 0, z = 2, rpy = [0.0, 0.0, 0.523598776] }"]
    {
        assert!(text.contains(line), "no {line}: {text}");
    }
    assert!(!text.contains("cart/"), "{text}");
    let ended = place.done(&["run", "cart.toml", "--set", "sweep=", "--set", "time.end=0.5", "--out", "out"]);
    ended.says(&["changes the motion in the simulator: <equality> (line 17)"]);
    let table = place.table("out/results.csv");
    let cell = |name: &str| *table.numbers(name).last().unwrap();
    // The ball falls by the file's gravity, from where the file places it; the spring pulls as it says.
    assert!((cell("q.free.z") - (2.0 - 0.5 * 3.7 * 0.25)).abs() < 1e-9, "{}", cell("q.free.z"));
    assert!((cell("slide_spring.force") - 30.0 * (cell("q.slide") - 0.3)).abs() < 1e-9);
    assert!(place.files("out/figures").contains(&"robot.svg".to_owned()), "{:?}", place.files("out/figures"));
}

#[test]
fn what_does_not_fit_is_said() {
    let place = place();
    place.write("arm.urdf", "<robot name=\"a\"><link name=\"b\"/></robot>");
    let rest = "[motion]\nkind = \"forward\"\n[time]\nend = 1\noutput_step = 1\n";
    for (robot, why) in [
        ("urdf = \"cart.xml\"", "write mjcf = \"cart.xml\""),
        ("mjcf = \"arm.urdf\"", "write urdf = \"arm.urdf\""),
        ("mjcf = \"none.xml\"", "none.xml"),
        ("mjcf = \"cart.xml\"\nurdf = \"arm.urdf\"", "leave one of them out"),
        ("mjcf = \"cart.xml\"\nfloating_base = true", "<freejoint>"),
    ] {
        place.write("s.toml", format!("[robot]\n{robot}\n{rest}"));
        place.springpot(&["check", "s.toml"]).ends(2, &[why]);
    }
    place.write("s.toml", format!("[robot]\nmjcf = \"cart.xml\"\ngravity = [0, 0, -1]\n{rest}"));
    let ended = place.done(&["check", "s.toml"]);
    assert!(ended.stdout.contains("cart.xml"), "{}", ended.stdout);
    place.springpot(&["info", "cart.xml", "--floating-base"]).ends(2, &["freejoint"]);
}
