//! Sweeps, grids and overrides.

use crate::support::{EXAMPLE, assert_all_refused, assert_refused, cases, catalog, edited, parameter, parse, single};
use springpot::fractional::scheme::Scheme;
use springpot::law::Catalog;
use springpot::system::{Action, RowTimes};
use springpot_scenario::RefusalKind::{BadName, BadQuantity, Rule, WrongType};
use springpot_scenario::{Cases, Plan, Refusals, Selection, ShapePlan, SweptValue};

/// The single run with these blocks behind it.
fn with_blocks(blocks: &str) -> String {
    edited(&single(), &[("[[figure]]", &format!("{blocks}\n[[figure]]"))])
}

fn grid(blocks: &str) -> Cases {
    cases(&with_blocks(blocks)).unwrap()
}

fn numbers(cases: &Cases) -> Vec<f64> {
    let number = |value: &SweptValue| match value {
        SweptValue::Number(number) => *number,
        SweptValue::Text(text) => panic!("{text} is no number"),
    };
    (0..cases.len()).map(|i| number(&cases.values(i)[0])).collect()
}

fn alpha(plan: &Plan) -> f64 {
    parameter(plan, "alpha")
}

fn temperature(plan: &Plan) -> f64 {
    plan.elements[0].inputs[0].constant.unwrap()
}

#[test]
fn a_file_without_sweeps_is_one_case() {
    let cases = cases(&single()).unwrap();
    assert_eq!((cases.len(), cases.axis_count()), (1, 0));
    assert!(cases.parameters().is_empty() && cases.values(0).is_empty() && cases.position(0).is_empty());
    assert_eq!(alpha(&cases.plan(0).unwrap()), 0.5);
}

#[test]
fn the_first_block_is_the_outer_loop() {
    let cases = grid(
        "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.2, 0.3]\n\
         [[sweep]]\nparameter = \"element.strut.T\"\nvalues = [\"0 degC\", \"25 degC\"]",
    );
    assert_eq!((cases.len(), cases.axis_count(), cases.axis_len(0), cases.axis_len(1)), (6, 2, 3, 2));
    assert_eq!(cases.parameters(), ["element.strut.alpha", "element.strut.T"]);
    assert_eq!(cases.axis_parameters(1).collect::<Vec<_>>(), ["element.strut.T"]);
    assert_eq!(cases.axis_label(1, 1), "25 degC");
    let wanted = [(0.1, 273.15), (0.1, 298.15), (0.2, 273.15), (0.2, 298.15), (0.3, 273.15), (0.3, 298.15)];
    for (i, (order, kelvin)) in wanted.into_iter().enumerate() {
        let plan = cases.plan(i).unwrap();
        assert_eq!((alpha(&plan), temperature(&plan)), (order, kelvin));
        assert_eq!(cases.values(i), [SweptValue::Number(order), SweptValue::Number(kelvin)]);
        assert_eq!(cases.position(i), [i / 2, i % 2]);
    }
    assert_eq!(cases.labels(3), ["0.2", "25 degC"]);
}

#[test]
fn a_list_of_paths_moves_together() {
    let cases =
        grid("[[sweep]]\nparameter = [\"element.strut.E_c\", \"element.strut.E_kv\"]\nvalues = [1, \"2 N/cm\"]");
    assert_eq!(cases.len(), 2);
    let plan = cases.plan(1).unwrap();
    assert_eq!(["E_c", "E_kv"].map(|name| parameter(&plan, name)), [200.0, 200.0]);
    assert_eq!(cases.values(1), [SweptValue::Number(200.0), SweptValue::Number(200.0)]);
    assert_eq!(cases.labels(1), ["2 N/cm", "2 N/cm"]);
}

#[test]
fn texts_are_swept_as_written() {
    let cases = grid(
        "[[sweep]]\nparameter = \"element.strut.scheme\"\nvalues = [\"exact\", \"expansion-2004(7)\"]\n\
         [[sweep]]\nparameter = \"motion.joints.q2\"\nvalues = [\"0.1*t\", 0]",
    );
    assert_eq!(cases.plan(2).unwrap().elements[0].element.scheme, Some(Scheme::Expansion2004(7)));
    assert_eq!(cases.values(2), [SweptValue::Text("expansion-2004(7)".into()), SweptValue::Text("0.1*t".into())]);
    assert_eq!(cases.values(3)[1], SweptValue::Number(0.0));
}

#[test]
fn what_the_file_leaves_out_can_be_swept() {
    let without = edited(
        &with_blocks("[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.2]"),
        &[("alpha = 0.5, ", "")],
    );
    let cases = crate::support::cases(&without).unwrap();
    assert_eq!(alpha(&cases.plan(1).unwrap()), 0.2);
    let cases = grid("[[sweep]]\nparameter = \"solver.max_step\"\nvalues = [1, \"1 ms\"]");
    assert_eq!(cases.plan(1).unwrap().settings.max_step, Some(0.001));
    let cases = grid("[[sweep]]\nparameter = \"robot.body.forearm.joint.damping\"\nvalues = [0, 1]");
    assert_eq!(cases.plan(1).unwrap().bodies[2].joint.damping[0], 1.0);
    let cases = grid("[[sweep]]\nparameter = \"element.strut.from.point\"\nvalues = [[0, 0, 0], [1, 0, 0]]");
    let plan = cases.plan(1).unwrap();
    let ShapePlan::Points(points) = &plan.elements[0].shape else { panic!("between points") };
    assert_eq!(points[0].point, [1.0, 0.0, 0.0]);
    assert_eq!(cases.values(1), [SweptValue::Text("[1, 0, 0]".into())]);
    let cases = grid("[[sweep]]\nparameter = \"element.strut.T_ref\"\nvalues = [\"10 degC\"]");
    assert_eq!(parameter(&cases.plan(0).unwrap(), "T_ref"), 283.15);
}

#[test]
fn spans_are_spaced_evenly() {
    let span = |values: &str| grid(&format!("[[sweep]]\nparameter = \"element.strut.E_c\"\nvalues = {{ {values} }}"));
    assert_eq!(numbers(&span("from = 0.1, to = 0.5, count = 5")), [0.1, 0.2, 0.3, 0.4, 0.5]);
    assert_eq!(numbers(&span("from = 1, to = 0, count = 3, scale = \"linear\"")), [1.0, 0.5, 0.0]);
    assert_eq!(numbers(&span("from = 1, to = 1e4, count = 5, scale = \"log\"")), [1.0, 10.0, 100.0, 1e3, 1e4]);
    let quantities = span("from = \"1 N/cm\", to = \"3 N/cm\", count = 3");
    assert_eq!(numbers(&quantities), [100.0, 200.0, 300.0]);
    assert_eq!(quantities.labels(1), ["2 N/cm"]);
    let warm =
        grid("[[sweep]]\nparameter = \"element.strut.T\"\nvalues = { from = \"0 degC\", to = \"60 degC\", count = 7 }");
    assert_eq!(numbers(&warm)[1..3], [283.15, 293.15]);
    assert_eq!(warm.labels(6), ["60 degC"]);
}

#[test]
fn long_sweeps_are_made_one_by_one() {
    let cases = grid(
        "[[sweep]]\nparameter = \"element.strut.E_c\"\nvalues = { from = \"0 N/m\", to = \"1000 N/m\", count = 100001 }\n\
         [[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = { from = 0.1, to = 0.9, count = 99 }",
    );
    assert_eq!(cases.len(), 9_900_099);
    let i = 99 * 70_000 + 98;
    assert_eq!(cases.values(i), [SweptValue::Number(700.0), SweptValue::Number(0.9)]);
    assert_eq!(cases.labels(i), ["700 N/m", "0.9"]);
    let plan = cases.plan(i).unwrap();
    assert_eq!((parameter(&plan, "E_c"), alpha(&plan)), (700.0, 0.9));
}

#[test]
fn a_bad_combination_fails_alone() {
    let text = edited(
        &with_blocks(
            "[[sweep]]\nparameter = \"time.end\"\nvalues = [1, 10]\n\
             [[sweep]]\nparameter = \"time.output_times\"\nvalues = [[0, 1], [0, 0.5]]",
        ),
        &[("output_step = \"10 ms\"", "output_times = [0]")],
    );
    let cases = crate::support::cases(&text).unwrap();
    assert_eq!(cases.plan(3).unwrap().settings.rows, RowTimes::Times([0.0, 0.5].into()));

    let roots = edited(
        &with_blocks(
            "[[sweep]]\nparameter = \"time.end\"\nvalues = [1, 10]\n\
             [[sweep]]\nparameter = \"motion.joints.q2\"\nvalues = [\"t\", \"sqrt(4 - t)\"]",
        ),
        &[],
    );
    let cases = crate::support::cases(&roots).unwrap();
    assert!(cases.plan(1).is_ok() && cases.plan(2).is_ok());
    let refusals = cases.plan(3).unwrap_err();
    assert!(refusals.to_string().contains("not finite at t ="), "{refusals}");
}

#[test]
fn figures_select_swept_values() {
    let text = edited(
        &with_blocks(
            "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.50, 1.0]\n\
             [[sweep]]\nparameter = \"element.strut.T\"\nvalues = [\"0 degC\", \"25 degC\"]",
        ),
        &[("x = \"t\" ", "where = { \"element.strut.parameters.alpha\" = 0.5, \"element.strut.T\" = \"298.15 K\" } ")],
    );
    let cases = cases(&text).unwrap();
    let wanted = [Selection { axis: 0, value: 1 }, Selection { axis: 1, value: 1 }];
    assert_eq!(cases.figures()[0].selection, wanted);
    assert_eq!(cases.plan(5).unwrap().output.figures[0].selection, wanted);
}

#[test]
fn figures_select_values_of_spans() {
    let text = edited(
        &with_blocks(
            "[[sweep]]\nparameter = \"element.strut.E_c\"\nvalues = { from = 1, to = 1e6, count = 100001, scale = \"log\" }\n\
             [[sweep]]\nparameter = \"element.strut.T\"\nvalues = { from = \"0 degC\", to = \"60 degC\", count = 7 }",
        ),
        &[("x = \"t\" ", "where = { \"element.strut.E_c\" = 1000, \"element.strut.T\" = \"20 degC\" } ")],
    );
    let cases = cases(&text).unwrap();
    let wanted = [Selection { axis: 0, value: 50_000 }, Selection { axis: 1, value: 2 }];
    assert_eq!(cases.figures()[0].selection, wanted);
    assert_eq!(cases.axis_label(0, 50_000), "1000");
}

fn set(text: &str, assignments: &[&str]) -> Result<Plan, Refusals> {
    let mut scenario = parse(text).unwrap();
    for assignment in assignments {
        scenario.set(assignment)?;
    }
    scenario.cases(&catalog())?.plan(0)
}

#[test]
fn overrides_use_the_same_paths() {
    let plan = set(
        &single(),
        &[
            "element.strut.alpha=0.7",
            " element.strut.T = 30 degC ",
            "solver.rtol=1e-6",
            "robot.body.forearm.mass = \"2500 g\"",
            "motion.joints.q1=0.1*sin(t)",
            "element.\"strut\".scheme=l1",
            "time.output_step=0.5 s",
            "title='other = title'",
            "output.columns=[\"t\"]",
            "figure.order.title=New",
            "robot.gravity=[0, 0, 0]",
        ],
    )
    .unwrap();
    assert_eq!(alpha(&plan), 0.7);
    assert_eq!(temperature(&plan), 303.15);
    assert_eq!(plan.settings.rtol, 1e-6);
    assert_eq!(plan.bodies[2].mass, 2.5);
    assert_eq!(plan.elements[0].element.scheme, Some(Scheme::L1));
    assert_eq!(plan.settings.rows, RowTimes::Step { step: 0.5, end: plan.settings.end });
    assert_eq!(plan.title.as_deref(), Some("other = title"));
    assert_eq!(plan.output.columns.unwrap()[0].text, "t");
    assert_eq!(plan.output.figures[0].title.as_deref(), Some("New"));
    assert_eq!(plan.gravity, [0.0; 3]);
}

/// What a file leaves out of three numbers is its default, whichever of them is set.
#[test]
fn components_that_the_file_leaves_out_are_set() {
    let text = r#"
[[robot.body]]
name = "arm"
joint = { name = "q", kind = "revolute", axis = [0, 1, 0] }
mass = 1
[motion]
kind = "forward"
[time]
end = 1
output_step = 0.1
"#;
    let assignments = [
        "robot.gravity.0=0.5",
        "robot.body.arm.com.0=0.2",
        "robot.body.arm.com.2='3 cm'",
        "robot.body.arm.joint.origin.1=1",
    ];
    let plan = set(text, &assignments).unwrap_or_else(|refusals| panic!("{refusals}"));
    assert_eq!(plan.gravity, [0.5, 0.0, -9.81]);
    assert_eq!(plan.bodies[0].com, [0.2, 0.0, 0.03]);
    assert_eq!(plan.bodies[0].joint.origin, [0.0, 1.0, 0.0]);
    let mut scenario = parse(text).unwrap();
    assignments.iter().for_each(|assignment| scenario.set(assignment).unwrap());
    let written = scenario.with_values(&catalog());
    let again = set(&written, &[]).unwrap_or_else(|refusals| panic!("{refusals}{written}"));
    assert_eq!((again.bodies[0].com, again.bodies[0].joint.origin), ([0.2, 0.0, 0.03], [0.0, 1.0, 0.0]));
    assert!(written.ends_with("# robot.gravity.0 was set, and has no place in this file\n"), "{written}");
    assert!(set(text, &["robot.body.arm.com.3=1"]).is_err());
}

#[test]
fn the_last_override_wins() {
    let plan = set(&single(), &["element.strut.alpha=0.7", "element.strut.parameters.alpha=0.2"]).unwrap();
    assert_eq!(alpha(&plan), 0.2);
}

#[test]
fn overrides_are_refused_in_their_own_text() {
    for (assignment, column, words) in [
        ("element.strut.alpha=1.5", 21, "is 1.5, outside 0 … 1"),
        ("element.strut.alpha = nan", 23, "is nan, not a finite number"),
        ("element.strut.alfa=1", 1, "has no `alfa`"),
        ("elemnt.strut.alpha=1", 1, "did you mean element.strut.alpha?"),
        ("element.strutt.alpha=1", 1, "did you mean `strut`?"),
        ("solver.rtoll=1", 1, "did you mean `rtol`?"),
        ("element.strut.T=25", 17, "25 K? write \"25 degC\""),
        ("element.strut.T=25 degX", 20, "unknown unit `degX`"),
        ("element.strut.rest_length=\"3 kg\"", 30, "`kg` does not fit: this place takes"),
        ("robot.body.forearm.com.x=1", 1, "components count from 0: 0 to 2"),
        ("sweep.x=1", 1, "a [[sweep]] has no name"),
        ("a b=1", 1, "is not a path"),
        ("element=1", 1, "leads to a whole table"),
        ("=1", 1, "has no path"),
        ("time.end", 1, "has no `=`"),
    ] {
        let refusals = set(&single(), &[assignment]).map(|_| ()).unwrap_err();
        let shown = refusals.to_string();
        let refusal = refusals.iter().find(|refusal| refusal.file == "--set");
        let refusal = refusal.unwrap_or_else(|| panic!("{assignment}: not in --set\n{shown}"));
        assert_eq!((refusal.line, refusal.column), (1, column), "{shown}");
        assert!(shown.contains(words), "{assignment}: no {words:?} in\n{shown}");
    }
}

#[test]
fn an_override_of_what_is_swept_is_refused() {
    let refusals = set(EXAMPLE, &["element.strut.alpha=0.5"]).map(|_| ()).unwrap_err();
    assert!(refusals.to_string().starts_with("--set:1:1: --set element.strut.alpha has no effect: it is swept"));
}

#[test]
fn the_standard_catalog_is_not_needed_to_parse() {
    let refusals = parse(EXAMPLE).unwrap().cases(&Catalog::standard()).map(|_| ());
    if Catalog::standard().get("thermoviscoelastic").is_none() {
        assert!(refusals.unwrap_err().to_string().contains("is no law"));
    }
}

#[test]
fn values_have_names_where_the_file_says_so() {
    let swept =
        "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.3]\nnames = [\"nearly a spring\", \"0.1\"]\n";
    let cases = grid(&format!(
        "{swept}[[sweep]]\nparameter = [\"element.strut.T\", \"solver.rtol\"]\nvalues = [[\"0 degC\", 1e-8], [\"25 degC\", 1e-9]]"
    ));
    assert_eq!(cases.axis_names(0), Some(&["nearly a spring".to_owned(), "0.1".to_owned()][..]));
    assert_eq!((cases.axis_names(1), cases.axis_label(0, 1)), (None, "0.1".to_owned()));
    assert_eq!(cases.name(0), "nearly a spring, element.strut.T = 0 degC, solver.rtol = 1e-8");
    assert_eq!((cases.given_name(3), cases.labels(3)[0].as_str()), ("0.1".to_owned(), "0.3"));
    // A figure finds values by name first, by value else.
    let with_figure = |chosen: &str| {
        let text = edited(
            &with_blocks(swept),
            &[("[[figure]]", &format!("[[figure]]\nwhere = {{ \"element.strut.alpha\" = {chosen} }}"))],
        );
        cases_of(&text).figures()[0].selection.clone()
    };
    for (chosen, value) in [("\"nearly a spring\"", 0), ("\"0.1\"", 1), ("0.3", 1)] {
        assert_eq!(with_figure(chosen), [Selection { axis: 0, value }], "{chosen}");
    }
    let span = grid(
        "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = { from = 0.1, to = 0.9, count = 3 }\nnames = [\"low\", \"middle\", \"high\"]",
    );
    assert_eq!(
        (span.name(1), span.axis_label_of(0, "element.strut.alpha", 1)),
        ("middle".to_owned(), "0.5".to_owned())
    );
}

fn cases_of(text: &str) -> Cases {
    cases(text).unwrap()
}

#[test]
fn names_of_values_are_refused_where_they_tell_none_apart() {
    let base =
        with_blocks("[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.3]\nnames = [\"a\", \"b\"]");
    let names = "names = [\"a\", \"b\"]";
    assert_all_refused(
        &base,
        &[
            (&[(names, "names = ‸[\"a\"]")], Rule, "holds 1 names for 2 values"),
            (&[(names, "names = ‸\"a\"")], WrongType, "an array of texts, one for each value"),
            (&[(names, "names = [\"a\", ‸\"a\"]")], BadName, "calls values 1 and 2 alike: \"a\""),
            (&[(names, "names = [\"a\", ‸\"\"]")], BadName, "is no name"),
            (&[(names, "names = [\"a\", ‸\" b\"]")], BadName, "begins or ends with a blank"),
            (&[(names, "names = [\"a\", ‸2]")], WrongType, "must be a text"),
        ],
    );
}

#[test]
fn elements_that_are_not_enabled_keep_their_columns() {
    let cases = grid("[[sweep]]\nparameter = \"element.strut.enabled\"\nvalues = [true, false]");
    let [with, without] = [0, 1].map(|k| cases.plan(k).unwrap());
    assert_eq!((with.elements.len(), without.elements.len(), without.absent.len()), (1, 0, 1));
    assert_eq!(with.columns(), without.columns());
    let system = without.system();
    assert!(system.elements.is_empty() && with.places(&with.system()).is_none());
    let (places, columns, own) = (without.places(&system).unwrap(), without.columns(), system.columns());
    for (place, column) in places.iter().zip(&columns) {
        match place {
            Some(place) => assert_eq!(own[*place].name, column.name),
            None => assert!(column.name.starts_with("strut."), "{}", column.name),
        }
    }
    assert_eq!(places.iter().flatten().count(), own.len());
    let elements = &without.resolved()["elements"];
    assert_eq!((&elements[0]["enabled"], &elements[0]["name"]), (&false.into(), &"strut".into()));
    assert!(with.resolved()["elements"][0].get("enabled").is_none());
    assert_all_refused(
        &single(),
        &[(&[("name = \"strut\"", "name = \"strut\"\nenabled = ‸\"no\"")], WrongType, "must be true or false")],
    );
}

#[test]
fn what_names_an_element_that_is_not_enabled() {
    let forward = |torque: &str, more: &str| {
        let text = edited(&single(), &[("name = \"strut\"", "name = \"strut\"\nenabled = false")]);
        let start = text.find("[motion]").unwrap();
        let end = text.find("[time]").unwrap();
        format!(
            "{}[motion]\nkind = \"forward\"\ntorque = {{ q2 = {torque} }}\n{more}\n{}",
            &text[..start],
            &text[end..]
        )
    };
    assert_refused(
        &forward("\"-3*strut.rate\"", ""),
        &(&[("-3*strut", "-3*‸strut")], BadQuantity, "strut.rate is of an element that is not enabled"),
    );
    // An event never happens, and what it sets there counts for nothing.
    let event = "[[event]]\nname = \"taut\"\nwhen = \"strut.force - 1\"\n\
                 [[event]]\nname = \"cold\"\nwhen = \"t - 1\"\naction = { set = { \"strut.T\" = \"20 degC\", \"tau.q1\" = 0 } }\n";
    let plan = cases_of(&forward("0", event)).plan(0).unwrap();
    assert!(plan.events[0].event.when.is_constant().is_some() && plan.events[0].event.columns.is_empty());
    let Action::Set(settings) = &plan.events[1].event.action else { panic!("it sets") };
    assert_eq!(settings.len(), 1);
    assert_eq!(plan.resolved()["events"][0]["when"], "strut.force - 1");
    // What it may not name at all is refused all the same.
    let text = forward("0", "[[event]]\nname = \"taut\"\nwhen = \"strut.farce - 1\"\n");
    assert_refused(&text, &(&[("\"strut.farce", "\"‸strut.farce")], BadQuantity, "did you mean `strut.force`?"));
}
