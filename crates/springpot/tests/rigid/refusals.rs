//! What the model builder refuses, and what it says.

use springpot::model::{
    Anchor, BodySpec, Field, JointKind, JointSpec, Mimic, Model, ModelBuilder, ModelError, Parent, Subject,
};

const DIAGONAL: [[f64; 3]; 3] = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];

fn body(name: &str, joint: &str) -> BodySpec {
    BodySpec {
        name: name.into(),
        parent: Parent::World,
        joint: JointSpec::revolute(joint, [0.0, 0.0, 1.0], [0.0; 3]),
        mass: 1.0,
        com: [0.1, 0.0, 0.0],
        inertia: DIAGONAL,
    }
}

fn build(bodies: impl IntoIterator<Item = BodySpec>) -> Result<Model, ModelError> {
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    for body in bodies {
        builder.push(body)?;
    }
    builder.finish()
}

/// The second body, changed, must be refused on `field` with a message that holds all `words`.
#[track_caller]
fn refused(change: impl FnOnce(&mut BodySpec), field: Field, words: &[&str]) -> ModelError {
    let mut second = body("arm", "q2");
    change(&mut second);
    let error = build([body("base", "q1"), second]).unwrap_err();
    assert_eq!(error.subject(), Some(Subject { body: 1, field }), "{error}");
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "\"{message}\" lacks \"{word}\"");
    }
    error
}

#[test]
fn names() {
    for bad in ["", "2nd", "a b", "a.b", "-x", "é", "a\n"] {
        refused(|b| b.name = bad.into(), Field::Name, &["name of body 1", bad, "letter"]);
        refused(|b| b.joint.name = bad.into(), Field::JointName, &["joint.name of body 1", bad]);
    }
    for good in ["_", "A-1", "left_arm-2"] {
        let named = BodySpec { name: good.into(), ..body("", good) };
        assert!(build([named]).is_ok(), "{good}");
    }
    let error = refused(|b| b.name = "world".into(), Field::Name, &["world", "inertial frame"]);
    assert!(matches!(error, ModelError::ReservedName { body: 1 }));
    let error = refused(|b| b.name = "base".into(), Field::Name, &["\"base\"", "body 0", "unique"]);
    assert!(matches!(error, ModelError::DuplicateName { first: 0, .. }));
    refused(|b| b.joint.name = "q1".into(), Field::JointName, &["\"q1\"", "body 0", "unique"]);
    // A joint may be called like a body, and a fixed joint's name counts as well.
    assert!(build([body("a", "b"), body("b", "a")]).is_ok());
    let fixed = BodySpec { joint: JointSpec::fixed("q1", [0.0; 3]), ..body("b", "") };
    assert!(matches!(build([body("a", "q1"), fixed]), Err(ModelError::DuplicateName { .. })));
}

#[test]
fn parents() {
    for parent in [1, 2, usize::MAX] {
        let error = refused(|b| b.parent = Parent::Body(parent), Field::Parent, &["\"arm\"", "earlier body"]);
        assert!(matches!(error, ModelError::ParentNotEarlier { body: 1, .. }));
    }
}

#[test]
fn numbers_that_are_not_finite() {
    type Change = fn(&mut BodySpec, f64);
    let changes: [(Field, Change); 8] = [
        (Field::Axis, |b, x| b.joint.axis[1] = x),
        (Field::Origin, |b, x| b.joint.origin[2] = x),
        (Field::Rpy, |b, x| b.joint.rpy[0] = x),
        (Field::Damping, |b, x| b.joint.damping[0] = x),
        (Field::Friction, |b, x| b.joint.friction[0] = x),
        (Field::Mass, |b, x| b.mass = x),
        (Field::Com, |b, x| b.com[1] = x),
        (Field::Inertia, |b, x| b.inertia[2][1] = x),
    ];
    for (field, change) in changes {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = refused(|b| change(b, x), field, &[field.key(), "\"arm\"", &x.to_string(), "finite"]);
            assert!(matches!(error, ModelError::NotFinite { .. }));
        }
    }
    let mut builder = ModelBuilder::new([0.0, f64::NAN, 0.0]);
    builder.push(body("a", "q")).unwrap();
    let error = builder.finish().unwrap_err();
    assert!(matches!(error, ModelError::GravityNotFinite { component: 1, .. }), "{error}");
    assert_eq!(error.subject(), None);
}

#[test]
fn signs_and_axes() {
    refused(|b| b.mass = -2.0, Field::Mass, &["mass", "\"arm\"", "-2", "0 or more"]);
    refused(|b| b.joint.damping[0] = -0.1, Field::Damping, &["joint.damping", "-0.1"]);
    refused(|b| b.joint.friction[0] = -0.1, Field::Friction, &["joint.friction", "-0.1"]);
    refused(|b| b.joint.axis = [0.0; 3], Field::Axis, &["\"q2\"", "[0, 0, 1]"]);
    // A fixed joint has no use for an axis, and length is no matter.
    let fixed = BodySpec { joint: JointSpec { axis: [0.0; 3], ..JointSpec::fixed("q", [0.0; 3]) }, ..body("b", "") };
    assert!(build([body("a", "p"), fixed]).is_ok());
    for length in [1e-310, 1e-200, 1e200] {
        let mut tiny = body("a", "q");
        tiny.joint.axis = [length, length, 0.0];
        assert!(build([tiny]).is_ok(), "{length}");
    }
}

#[test]
fn inertias() {
    let error =
        refused(|b| b.inertia[0][1] = 0.01, Field::Inertia, &["not symmetric", "[0][1] is 0.01", "[1][0] is 0"]);
    assert!(matches!(error, ModelError::AsymmetricInertia { row: 0, column: 1, .. }));
    refused(
        |b| b.inertia = [[0.1, 0.2, 0.0], [0.2, 0.1, 0.0], [0.0, 0.0, 0.2]],
        Field::Inertia,
        &["\"arm\"", "principal moment -0.1", "0 or more"],
    );
    refused(|b| b.inertia = [[-0.1, 0.0, 0.0], [0.0; 3], [0.0; 3]], Field::Inertia, &["principal moment -0.1"]);
    let error = refused(
        |b| b.inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.3]],
        Field::Inertia,
        &["0.3", "sum 0.2", "no distribution"],
    );
    assert!(matches!(error, ModelError::TriangleInequality { .. }));

    // The border of both rules: a lamina and a rod are physical, rounding is forgiven, more is not.
    let diagonal =
        |x: f64, y: f64, z: f64| BodySpec { inertia: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], ..body("a", "q") };
    assert!(build([diagonal(0.1, 0.2, 0.1 + 0.2)]).is_ok());
    assert!(build([diagonal(0.0, 0.5, 0.5)]).is_ok());
    assert!(build([diagonal(0.1, 0.1, 0.2 * (1.0 + 0.9e-9))]).is_ok());
    assert!(build([diagonal(0.1, 0.1, 0.2 * (1.0 + 1.1e-9))]).is_err());
    assert!(build([diagonal(-0.9e-12, 1.0, 1.0)]).is_ok());
    assert!(matches!(build([diagonal(-1.1e-12, 1.0, 1.0)]), Err(ModelError::InertiaNotPositive { .. })));
}

#[test]
fn a_singular_mass_matrix_names_the_joint() {
    let massless = |name: &str, joint: &str| BodySpec { mass: 0.0, inertia: [[0.0; 3]; 3], ..body(name, joint) };
    let on = |parent: usize, spec: BodySpec| BodySpec { parent: Parent::Body(parent), ..spec };
    #[track_caller]
    fn singular_at(joint: &str, bodies: impl IntoIterator<Item = BodySpec>) {
        match build(bodies) {
            Err(error @ ModelError::SingularMassMatrix { .. }) => {
                assert!(error.to_string().contains(&format!("joint \"{joint}\"")), "{error}");
                assert_eq!(error.subject().unwrap().field, Field::Mass);
            }
            other => panic!("{other:?}"),
        }
    }

    singular_at("q1", [massless("a", "q1")]);
    singular_at("q2", [body("a", "q1"), on(0, massless("b", "q2"))]);
    // A chain of massless bodies, and a branch of one.
    singular_at("q3", [body("a", "q1"), on(0, massless("b", "q2")), on(1, massless("c", "q3"))]);
    singular_at("q3", [body("a", "q1"), on(0, body("b", "q2")), on(0, massless("c", "q3"))]);
    // A point mass on the axis.
    singular_at("q1", [BodySpec { com: [0.0, 0.0, 0.4], inertia: [[0.0; 3]; 3], ..body("a", "q1") }]);
    // A massless body that turns about the very axis of the next one is free in every configuration.
    singular_at("q1", [massless("a", "q1"), on(0, body("b", "q2"))]);
    // Sliders along one line likewise; four sliders in space cannot be told apart by one mass.
    let slider = |spec: BodySpec, axis: [f64; 3]| BodySpec {
        joint: JointSpec::prismatic(spec.joint.name.clone(), axis, [0.0; 3]),
        ..spec
    };
    singular_at(
        "q1",
        [
            slider(massless("a", "q1"), [1.0, 1.0, 1.0]),
            on(0, slider(massless("b", "q2"), [1.0, 0.0, 0.0])),
            on(1, slider(massless("c", "q3"), [0.0, 1.0, 0.0])),
            on(2, slider(body("d", "q4"), [0.0, 0.0, 1.0])),
        ],
    );

    // Massless bodies in between are fine where what they carry resists.
    let mut elbow = on(0, body("b", "q2"));
    elbow.joint.axis = [0.0, 1.0, 0.0];
    assert!(build([massless("a", "q1"), elbow]).is_ok());
    let load = BodySpec { joint: JointSpec::fixed("weld", [0.3, 0.0, 0.0]), ..body("load", "") };
    assert!(build([massless("a", "q1"), on(0, load)]).is_ok());
    // Point masses on massless rods: singular in single configurations only.
    let bob = |name: &str, joint: &str| BodySpec { inertia: [[0.0; 3]; 3], ..body(name, joint) };
    let mut second = on(0, bob("b", "q2"));
    second.joint.origin = [0.1, 0.0, 0.0];
    assert!(build([bob("a", "q1"), second]).is_ok());
    // Robots of any size.
    for size in [1e-6, 1e-3, 1e3] {
        let scaled = |name: &str, joint: &str| {
            let mut spec = body(name, joint);
            spec.com = spec.com.map(|x| x * size);
            spec.inertia = spec.inertia.map(|row| row.map(|x| x * size * size));
            spec.joint.origin = [0.3 * size, 0.0, 0.1 * size];
            spec
        };
        let links = [
            scaled("a", "q1"),
            on(0, slider(scaled("b", "q2"), [0.0, 1.0, 1.0])),
            on(1, scaled("c", "q3")),
            on(2, scaled("d", "q4")),
        ];
        assert!(build(links).is_ok(), "{size}");
    }
}

#[test]
fn overflow_and_emptiness() {
    let error = refused(|b| b.com = [1e200, 0.0, 0.0], Field::Mass, &["\"arm\"", "overflow"]);
    assert!(matches!(error, ModelError::Overflow { .. }));
    let error = build([]).unwrap_err();
    assert_eq!(error, ModelError::NoBodies);
    assert_eq!(error.subject(), None);
}

#[test]
fn a_refused_body_leaves_the_builder_as_it_was() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    builder.push(body("a", "q1")).unwrap();
    assert!(builder.push(BodySpec { mass: -1.0, ..body("b", "q2") }).is_err());
    assert!(builder.push(body("a", "q2")).is_err());
    assert!(builder.push(body("b", "q1")).is_err());
    assert_eq!(builder.push(body("b", "q2")), Ok(1));
    let model = builder.finish().unwrap();
    assert_eq!(model.joint_names(), ["q1", "q2"]);
    assert_eq!(model.body_names(), ["a", "b"]);
}

#[test]
fn anchors() {
    let model = build([body("a", "q1")]).unwrap();
    let error = model.resolve(&Anchor { body: Parent::Body(1), point: [0.0; 3] }).unwrap_err();
    assert_eq!(error, ModelError::NoSuchBody { body: 1, count: 1 });
    let error = model.resolve(&Anchor { body: Parent::World, point: [0.0, f64::NAN, 0.0] }).unwrap_err();
    assert!(error.to_string().contains("finite"));
    assert_eq!(model.frame(Parent::Body(7)), Err(ModelError::NoSuchBody { body: 7, count: 1 }));
}

#[test]
fn what_the_model_tells() {
    let mut fixed = body("plate", "weld");
    fixed.joint.kind = JointKind::Fixed;
    let slider = BodySpec {
        parent: Parent::Body(0),
        joint: JointSpec {
            damping: [3.0; 3],
            friction: [0.5; 3],
            ..JointSpec::prismatic("slide", [1.0, 0.0, 0.0], [0.0; 3])
        },
        ..body("carriage", "")
    };
    let turntable = BodySpec { parent: Parent::Body(1), ..body("table", "turn") };
    let model = build([fixed, slider, turntable]).unwrap();
    assert_eq!((model.nq(), model.nv()), (2, 2));
    assert_eq!(model.joint_names(), ["slide", "turn"]);
    assert_eq!((model.joint_index("turn"), model.joint_index("weld")), (Some(1), None));
    assert_eq!(
        (model.described_joint(0).kind, model.described_joint(1).kind),
        (JointKind::Prismatic, JointKind::Revolute)
    );
    assert_eq!((model.joint_body(0), model.joint_body(1)), (1, 2));
    assert_eq!((model.damping(), model.friction()), (&[3.0, 0.0][..], &[0.5, 0.0][..]));
    assert_eq!((model.body_index("table"), model.body_index("none")), (Some(2), None));
    assert_eq!(model.gravity(), [0.0, 0.0, -9.81]);
    assert_eq!(model.frame(Parent::Body(0)).unwrap().link(), 0);
    assert_eq!(model.subtree_mass(0), 2.0);
    fn shared(_: &(impl Send + Sync)) {}
    shared(&model);
}

/// Two sliders in a row with a joint before them that is `first`, the second slider following `followed`.
fn followers(first: JointSpec, followed: &str) -> Result<Model, ModelError> {
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    let slider = |name: &str, mimic: Option<Mimic>| JointSpec {
        mimic,
        ..JointSpec::prismatic(name, [1.0, 0.0, 0.0], [0.1, 0.0, 0.0])
    };
    let mimic = |joint: &str| Some(Mimic { joint: joint.into(), multiplier: -0.5, offset: 0.25 });
    for (k, joint) in [first, slider("q2", mimic("q1")), slider("q3", mimic(followed))].into_iter().enumerate() {
        let parent = k.checked_sub(1).map_or(Parent::World, Parent::Body);
        builder.push(BodySpec { name: format!("b{k}"), parent, joint, ..body("link", "q1") })?;
    }
    builder.finish()
}

#[test]
fn joints_that_follow_others() {
    let turn = || JointSpec::revolute("q1", [0.0, 0.0, 1.0], [0.0; 3]);
    let model = followers(turn(), "q2").unwrap();
    assert_eq!((model.nq(), model.nv(), model.joint_count()), (1, 1, 3));
    assert_eq!((model.followed(0), model.followed(1)), (None, Some((0, -0.5, 0.25))));
    // q3 = −½ (−½ q1 + ¼) + ¼
    assert_eq!(model.followed(2), Some((0, 0.25, 0.125)));

    let told = |result: Result<Model, ModelError>| result.unwrap_err().to_string();
    assert_eq!(told(followers(turn(), "q9")), "joint \"q3\" follows joint \"q9\", which does not exist");
    let circle = JointSpec { mimic: Some(Mimic { joint: "q3".into(), multiplier: 1.0, offset: 0.0 }), ..turn() };
    assert_eq!(told(followers(circle, "q1")), "joint \"q1\" follows itself, directly or through other joints");
    let free = || JointSpec::floating("q1", [0.0; 3]);
    let expected = "joint \"q2\" follows joint \"q1\", which has not exactly one degree of freedom";
    assert_eq!(told(followers(free(), "q2")), expected);
    let bound = JointSpec { mimic: Some(Mimic { joint: "q3".into(), multiplier: 1.0, offset: 0.0 }), ..free() };
    let expected =
        "joint \"q1\" is floating, so it cannot follow another joint; only joints of one degree of freedom can";
    assert_eq!(told(followers(bound, "q3")), expected);
    let endless = JointSpec { mimic: Some(Mimic { joint: "q3".into(), multiplier: f64::NAN, offset: 0.0 }), ..turn() };
    assert!(told(followers(endless, "q1")).contains("joint.mimic"));
}

#[test]
fn links_of_a_urdf_are_physical_together() {
    let build = |inertia: [f64; 3], com: [f64; 3], fixed: [f64; 3]| {
        let diagonal = |[x, y, z]: [f64; 3]| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        let mut builder = ModelBuilder::of_urdf([0.0, 0.0, -9.81]);
        builder.push(BodySpec { name: "a link/1".into(), inertia: diagonal(inertia), com, ..body("link", "q1") })?;
        let joint = JointSpec::fixed("weld", [0.0; 3]);
        let load = BodySpec {
            name: "load".into(),
            parent: Parent::Body(0),
            joint,
            inertia: diagonal(fixed),
            ..body("link", "q1")
        };
        builder.push(BodySpec { com, ..load })?;
        builder.finish()
    };
    // Together 1.2, 1.2, 2: one alone breaks the triangle inequality, and so does a part with a negative moment.
    assert!(build([0.2, 0.2, 1.0], [0.0; 3], [1.0, 1.0, 1.0]).is_ok());
    assert!(build([1.0, 1.0, 1.0], [0.0; 3], [-0.2, 0.2, 0.2]).is_ok());
    let refused = build([0.2, 0.2, 1.0], [0.0; 3], [0.1, 0.1, 0.1]).unwrap_err();
    assert!(matches!(refused, ModelError::TriangleInequality { body: 0, .. }), "{refused}");
    let refused = build([0.1, 0.1, 0.1], [0.0; 3], [-0.2, 0.2, 0.2]).unwrap_err();
    assert!(matches!(refused, ModelError::InertiaNotPositive { body: 0, .. }), "{refused}");
    // Point masses far from the joint: their inertia about it says nothing about that about their centre.
    assert!(build([0.0; 3], [0.3, 0.7, -12.3], [0.0; 3]).is_ok());
}
