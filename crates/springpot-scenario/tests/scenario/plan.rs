//! The example of the format, whole: what its plan holds.

use crate::support::{EXAMPLE, cases, catalog, coordinates, edited, parameter, parse, single};
use springpot::law::Derivative;
use springpot::model::{Anchor, JointKind, Parent};
use springpot::system::RowTimes;
use springpot_scenario::{FigureKind, ShapePlan, SweptValue};

#[test]
fn the_example_is_planned_whole() {
    let cases = cases(EXAMPLE).unwrap();
    assert_eq!(cases.len(), 6);
    assert_eq!(cases.parameters(), ["element.strut.alpha"]);
    for (i, alpha) in [0.1, 0.3, 0.5, 0.7, 0.9, 1.0].into_iter().enumerate() {
        assert_eq!(cases.values(i), [SweptValue::Number(alpha)]);
        assert_eq!(cases.labels(i), [if alpha == 1.0 { "1.0".to_owned() } else { alpha.to_string() }]);
        let plan = cases.plan(i).unwrap();
        for (name, value) in
            [("E_c", 30.0), ("E_kv", 20.0), ("E_d", 50.0), ("alpha", alpha), ("a_kv", 0.0007), ("T_ref", 273.15)]
        {
            assert_eq!(parameter(&plan, name), value, "{name}");
        }
    }

    let plan = cases.plan(2).unwrap();
    assert_eq!(plan.title.as_deref(), Some("Thermoviscoelastic strut on a three-body robot"));
    assert_eq!(plan.gravity, [0.0, 0.0, -9.81]);

    assert_eq!(plan.bodies.len(), 3);
    assert_eq!((plan.model.nq(), plan.model.body_names().len()), (3, 3));
    let names: Vec<&str> = plan.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["column", "upper_arm", "forearm"]);
    assert_eq!(plan.joint_names().collect::<Vec<_>>(), ["q1", "q2", "q3"]);
    let parents: Vec<Parent> = plan.bodies.iter().map(|body| body.parent).collect();
    assert_eq!(parents, [Parent::World, Parent::Body(0), Parent::Body(1)]);
    let forearm = &plan.bodies[2];
    assert_eq!(forearm.joint.kind, JointKind::Revolute);
    assert_eq!(forearm.joint.axis, [0.0, 1.0, 0.0]);
    assert_eq!(forearm.joint.origin, [0.5, 0.0, 0.0]);
    assert_eq!(forearm.joint.rpy, [0.0; 3]);
    assert_eq!((forearm.joint.damping[0], forearm.joint.friction[0]), (0.0, 0.0));
    assert_eq!(forearm.mass, 2.0);
    assert_eq!(forearm.com, [0.18, -0.01, 0.01]);
    assert_eq!(forearm.inertia, [[0.006, 0.0, -0.001], [0.0, 0.03, 0.0004], [-0.001, 0.0004, 0.03]]);
    assert_eq!(plan.bodies[1].inertia, [[0.01, 0.001, 0.0], [0.001, 0.07, 0.0005], [0.0, 0.0005, 0.07]]);
    assert_eq!(plan.body_places[1].at("joint.axis").position(), (13, 50));
    assert_eq!(plan.body_places[1].at("joint.rpy").position(), (11, 1));

    let gripper = plan.gripper.as_ref().unwrap();
    assert_eq!(gripper.body, "forearm");
    assert_eq!(gripper.anchor, Anchor { body: Parent::Body(2), point: [0.4, 0.0, 0.0] });

    let [strut] = &plan.elements[..] else { panic!("one element") };
    assert_eq!(strut.element.name, "strut");
    let ShapePlan::Points(points) = &strut.shape else { panic!("between points") };
    let from = Anchor { body: Parent::Body(0), point: [0.14, -0.1, 0.08] };
    assert_eq!(points[..], [from, Anchor { body: Parent::Body(2), point: [-0.06, 0.1, 0.08] }]);
    assert_eq!(strut.element.rest, 0.7);
    assert_eq!(strut.element.entry.name, "thermoviscoelastic");
    assert_eq!(strut.inputs[0].constant, Some(298.15));
    assert_eq!(strut.inputs[0].written, "25 degC");
    assert_eq!(strut.element.derivative, Derivative::RiemannLiouville);
    assert_eq!(strut.element.scheme, None);

    let joints = coordinates(&plan);
    assert_eq!(joints[0].is_constant(), Some(0.0));
    assert_eq!([1, 2].map(|joint: usize| joints[joint].value(0.5)), [0.1 * 4f64.sin(), 0.05]);
    let written = serde_json::json!({ "q1": 0.0, "q2": "0.1*sin(8*t)", "q3": "0.1*t" });
    assert_eq!(plan.resolved()["motion"]["joints"], written);

    assert_eq!(plan.settings.end, 10.0);
    assert_eq!(plan.settings.rows, RowTimes::Step { step: 0.01, end: 10.0 });
    assert_eq!(plan.settings.rows.count(), 1001);
    assert_eq!(plan.settings.rows.at(1000), 10.0);

    let solver = &plan.settings;
    assert_eq!((solver.rtol, solver.atol, solver.memory_rtol), (1e-9, None, 1e-9 / 100.0));
    assert_eq!((solver.first_step, solver.max_step, solver.max_steps), (None, None, None));

    let [figure] = &plan.output.figures[..] else { panic!("one figure") };
    assert_eq!(figure.name, "order");
    assert_eq!(figure.title.as_deref(), Some("Generalized force Q₂ at 25 °C"));
    let FigureKind::Curves { x, y } = &figure.kind else { panic!("curves") };
    assert_eq!(x.text, "t");
    assert_eq!(y[0].text, "strut.Q.q2");
    assert_eq!(y[0].place.position(), (59, 6));
    assert!(figure.units.is_empty() && figure.selection.is_empty());
    assert!(plan.output.columns.is_none());
}

#[test]
fn the_resolved_plan_has_every_default() {
    let resolved = cases(EXAMPLE).unwrap().plan(2).unwrap().resolved();
    assert_eq!(resolved["elements"][0]["parameters"]["T_ref"], 273.15);
    assert_eq!(resolved["elements"][0]["parameters"]["alpha"], 0.5);
    assert_eq!(resolved["elements"][0]["inputs"]["T"], 298.15);
    assert_eq!(resolved["elements"][0]["rest_length"], 0.7);
    assert_eq!(resolved["elements"][0]["from"]["body"], "column");
    assert_eq!(resolved["elements"][0]["scheme"], "exact");
    assert_eq!(resolved["elements"][0]["derivative"], "riemann-liouville");
    assert_eq!(resolved["bodies"][1]["parent"], "column");
    assert_eq!(resolved["bodies"][1]["inertia"]["xy"], 0.001);
    assert_eq!(resolved["motion"]["joints"]["q2"], "0.1*sin(8*t)");
    assert_eq!(resolved["motion"]["joints"]["q1"], 0.0);
    assert_eq!(resolved["solver"]["memory_rtol"], 1e-9 / 100.0);
    assert_eq!(resolved["time"]["output_step"], 0.01);
    assert_eq!(resolved["time"]["rows"], 1001);
    assert_eq!(resolved["gripper"]["point"][0], 0.4);
    assert_eq!(resolved["figures"][0]["y"][0], "strut.Q.q2");
}

#[test]
fn solver_defaults_follow_rtol() {
    let solver = |lines: &str| {
        let text = edited(&single(), &[("rtol = 1e-9       ", lines)]);
        cases(&text).unwrap().plan(0).unwrap().settings
    };
    let loose = solver("rtol = 1e-5");
    assert_eq!((loose.rtol, loose.atol, loose.memory_rtol), (1e-5, None, 1e-5 / 100.0));
    let tight = solver("rtol = 1e-11");
    assert_eq!((tight.rtol, tight.memory_rtol), (1e-11, 1e-12));
    let all = solver("atol = 1e-8\nmemory_rtol = 1e-10\nfirst_step = \"1 ms\"\nmax_step = 0.1\nmax_steps = 500");
    assert_eq!((all.rtol, all.atol, all.memory_rtol), (1e-9, Some(1e-8), 1e-10));
    assert_eq!((all.first_step, all.max_step, all.max_steps), (Some(0.001), Some(0.1), Some(500)));
}

#[test]
fn a_gripper_path_is_planned() {
    let text = edited(
        &single(),
        &[(
            "kind = \"prescribed\"\njoints = { q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }",
            "kind = \"gripper-path\"\nx = \"80 cm\"\ny = \"0.1*sin(t)\"\nz = 0.3\nrpy = [0, \"90 deg\", 0]\nguess = { q3 = 1.0 }",
        )],
    );
    let plan = cases(&text).unwrap().plan(0).unwrap();
    assert!(plan.motion.has_path() && !plan.motion.is_forward());
    let expected = serde_json::json!({
        "kind": "gripper-path",
        "x": 0.8,
        "y": "0.1*sin(t)",
        "z": 0.3,
        "rpy": [0.0, std::f64::consts::FRAC_PI_2, 0.0],
        "guess": { "q1": 0.0, "q2": 0.0, "q3": 1.0 },
    });
    assert_eq!(plan.resolved()["motion"], expected);
}

#[test]
fn joints_take_quantities_of_their_kind() {
    let text = edited(
        &single(),
        &[
            (
                "kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0] }",
                "kind = \"prismatic\", axis = [0, 0, 2], damping = \"2 N*s/m\", friction = \"3 N\", rpy = [0, 0, \"180 deg\"] }",
            ),
            (
                "axis = [0, 1, 0], origin = [0, 0, 0.6] }",
                "axis = [0, 1, 0], damping = \"0.1 N*m*s/rad\", friction = \"0.2 N*m\" }",
            ),
            ("joints = { q1 = 0,", "joints = { q1 = \"5 cm\","),
        ],
    );
    let plan = cases(&text).unwrap().plan(0).unwrap();
    assert_eq!(plan.bodies[0].joint.kind, JointKind::Prismatic);
    assert_eq!((plan.bodies[0].joint.damping[0], plan.bodies[0].joint.friction[0]), (2.0, 3.0));
    assert_eq!((plan.bodies[1].joint.damping[0], plan.bodies[1].joint.friction[0]), (0.1, 0.2));
    assert_eq!(plan.bodies[0].joint.rpy[2], std::f64::consts::PI);
    let joints = coordinates(&plan);
    assert_eq!(joints[0].is_constant(), Some(0.05));
}

#[test]
fn exponents_follow_the_law() {
    let plan = |unit: &str, alpha: &str| {
        let text = edited(
            &single(),
            &[("\"50 N*s^alpha/m\"", &format!("\"{unit}\"")), ("alpha = 0.5, a_kv", &format!("alpha = {alpha}, a_kv"))],
        );
        cases(&text).and_then(|cases| cases.plan(0)).map(|plan| parameter(&plan, "E_d"))
    };
    assert_eq!(plan("50 N*s^0.5/m", "0.5"), Ok(50.0));
    assert_eq!(plan("50 N*s/m", "1"), Ok(50.0));
    assert_eq!(plan("50 N*s^alpha/m", "0.3"), Ok(50.0));
    assert_eq!(plan("0.5 N*s^alpha/cm", "0.3"), Ok(50.0));
    assert!(plan("50 N*s^0.5/m", "0.6").is_err());
    assert!(plan("50 N*s/m", "0.5").is_err());
}

#[test]
fn output_times_and_columns_are_taken() {
    let text = edited(
        &single(),
        &[
            ("output_step = \"10 ms\"  ", "output_times = [0, \"500 ms\", 10]"),
            ("# columns = [\"t\", \"strut.*\"]", "columns = [\"t\", \"strut.*\"]"),
        ],
    );
    let plan = cases(&text).unwrap().plan(0).unwrap();
    assert_eq!(plan.settings.rows, RowTimes::Times([0.0, 0.5, 10.0].into()));
    assert_eq!(plan.settings.rows.count(), 3);
    let columns: Vec<&str> =
        plan.output.columns.iter().flat_map(|globs| globs.iter()).map(|glob| glob.text.as_str()).collect();
    assert_eq!(columns, ["t", "strut.*"]);
}

#[test]
fn output_times_have_equal_ratios_or_differences() {
    let rows = |table: &str| {
        let text = edited(&single(), &[("output_step = \"10 ms\"  ", &format!("output_times = {table}"))]);
        cases(&text).unwrap().plan(0).unwrap().settings.rows
    };
    let decades = rows("{ from = \"1 ms\", to = 10, count = 5, scale = \"log\" }");
    assert_eq!(decades, RowTimes::Times([1e-3, 0.01, 0.1, 1.0, 10.0].into()));
    assert_eq!(rows("{ from = 0, to = 1, count = 5 }"), RowTimes::Times([0.0, 0.25, 0.5, 0.75, 1.0].into()));
}

#[test]
fn figures_get_names_units_and_kinds() {
    let text = edited(
        &single(),
        &[
            ("name = \"order\"", "x = \"strut.stroke\""),
            ("[output]", "units = { \"strut.Q.q2\" = \"N*cm\" }\n[[figure]]\nkind = \"robot\"\n[output]"),
        ],
    );
    let text = text.replace("x = \"t\"", "");
    let cases = cases(&text).unwrap();
    let [first, second] = cases.figures() else { panic!("two figures") };
    assert_eq!((first.name.as_str(), second.name.as_str()), ("figure-1", "figure-2"));
    assert_eq!(first.units[0].column.text, "strut.Q.q2");
    assert_eq!(first.units[0].unit, "N*cm");
    assert!(matches!(&first.kind, FigureKind::Curves { x, .. } if x.text == "strut.stroke"));
    assert_eq!(second.kind, FigureKind::Robot);
    let resolved = cases.plan(0).unwrap().resolved();
    let kinds: Vec<&str> =
        resolved["figures"].as_array().unwrap().iter().map(|figure| figure["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["curves", "robot"]);
}

#[test]
fn signals_come_from_tables_and_csv_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.csv"), "t,q1,q3,q2,T\n0,0,0,0.5,20\n5,1,1,1,25\n6,1,1,1,25\n10,2,1,1,30\n")
        .unwrap();
    let text = edited(
        &single(),
        &[
            ("joints = { q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }", "csv = \"m.csv\""),
            ("inputs = { T = \"25 degC\" }", "inputs = { T = { csv = \"m.csv\", column = \"T\", unit = \"degC\" } }"),
        ],
    );
    std::fs::write(folder.path().join("arm.toml"), text).unwrap();
    let scenario = springpot_scenario::Scenario::read(folder.path().join("arm.toml")).unwrap();
    let plan = scenario.cases(&catalog()).unwrap().plan(0).unwrap();
    let joints = coordinates(&plan);
    assert_eq!(joints.len(), 3);
    assert_eq!(joints[1].at(0.0).value, 0.5);
    assert_eq!(plan.elements[0].inputs[0].signal.at(0.0).value, 293.15);
}

#[test]
fn a_scaled_expression_is_in_its_unit() {
    let edit = [("T = \"25 degC\"", "T = { expression = \"25 + 5*sin(t)\", unit = \"degC\" }")];
    let plan = parse(&edited(&single(), &edit)).unwrap().cases(&catalog()).unwrap().plan(0).unwrap();
    assert_eq!(plan.elements[0].inputs[0].signal.at(0.0).value, 298.15);
    assert_eq!(plan.elements[0].inputs[0].constant, None);
}

#[test]
fn plans_and_cases_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<springpot_scenario::Plan>();
    shared::<springpot_scenario::Cases>();
    shared::<springpot_scenario::Scenario>();
    shared::<springpot_scenario::Refusals>();
}
