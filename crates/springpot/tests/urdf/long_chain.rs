//! Robots of very many links: no recursion, and time in proportion to their length.

use crate::support::parse_with;
use crate::work::Work;
use springpot::model::description::DescriptionOptions;
use std::fmt::Write;
use std::time::Duration;

/// A chain of `count` joints, the last link first.
fn chain(count: usize, joint: impl Fn(usize) -> String) -> String {
    let mut text = String::from("<robot name=\"chain\">\n<link name=\"0\"/>\n");
    for k in (1..=count).rev() {
        let inertia = "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/>";
        writeln!(
            text,
            "<link name=\"{k}\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"1\"/>{inertia}</inertial></link>"
        )
        .unwrap();
        writeln!(
            text,
            "<joint name=\"j{k}\" {} <origin xyz=\"0 0 0.2\"/><parent link=\"{}\"/><child link=\"{k}\"/>\
             <axis xyz=\"0 1 0\"/></joint>",
            joint(k),
            k - 1
        )
        .unwrap();
    }
    text + "</robot>"
}

/// Work to read it, the least of three times.
fn time(text: &str) -> Duration {
    let read = || {
        let work = Work::begin();
        assert!(parse_with(text, &DescriptionOptions::default()).is_ok());
        work.done()
    };
    read().min(read()).min(read())
}

#[test]
fn a_hundred_thousand_links_are_read_and_built() {
    const COUNT: usize = 100_000;
    let text = chain(COUNT, |_| "type=\"continuous\">".to_owned());
    let urdf = parse_with(&text, &DescriptionOptions::default()).unwrap();
    assert_eq!((urdf.bodies.len(), urdf.warnings.len()), (COUNT, 0));
    let model = urdf.model([0.0, 0.0, -9.81]).unwrap();
    assert_eq!((model.nv(), model.subtree_mass(0)), (COUNT, COUNT as f64));
    let tenth = chain(COUNT / 10, |_| "type=\"continuous\">".to_owned());
    let (long, short) = (time(&text), time(&tenth));
    println!("{long:?} for {COUNT} links, {short:?} for a tenth of them");
    assert!(long < 40 * short.max(Duration::from_millis(1)), "{long:?} against {short:?} for a tenth");
    assert!(long < Duration::from_secs(5), "{long:?}");
}

#[test]
fn a_circle_of_a_hundred_thousand_links_is_refused() {
    const COUNT: usize = 100_000;
    let text = chain(COUNT, |_| "type=\"fixed\">".to_owned());
    let text = text.replace("<parent link=\"0\"/>", &format!("<parent link=\"{COUNT}\"/>"));
    let error = parse_with(&text, &DescriptionOptions::default()).expect_err("a circle");
    assert!(error.to_string().contains("carry one another in a circle"), "{error}");
    assert!(error.to_string().len() < 300, "{error}");
}

#[test]
fn a_circle_of_a_hundred_thousand_mimic_joints_is_refused() {
    const COUNT: usize = 100_000;
    let text = chain(COUNT, |k| format!("type=\"continuous\"><mimic joint=\"j{}\"/>", k % COUNT + 1));
    let error = parse_with(&text, &DescriptionOptions::default()).expect_err("a circle");
    assert!(error.to_string().contains("mimic one another in a circle"), "{error}");
}
