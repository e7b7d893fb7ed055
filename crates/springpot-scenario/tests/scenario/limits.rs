//! Refusals of sweeps, files, broken texts and absurd sizes. The mark ‸ in an edit is where the refusal must point.

use crate::support::{EXAMPLE, assert_all_refused, edited, marked, refusals, single};
use springpot_scenario::RefusalKind::*;
use springpot_scenario::Scenario;

const JOINTS: &str = "joints = { q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }";

#[test]
fn sweeps_are_refused() {
    let values = "values = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0]";
    let parameter = "parameter = \"element.strut.alpha\"";
    let second =
        "[[sweep]]\nparameter = \"element.strut.E_d\"\nvalues = { from = 1, to = 2, count = 2000000 }\n[[figure]]";
    assert_all_refused(
        EXAMPLE,
        &[
            (&[(parameter, "parameter = ‸\"element.strutt.alpha\"")], UnknownName, "did you mean `strut`?"),
            (
                &[(parameter, "parameter = ‸\"element.strut.alfa\"")],
                UnknownName,
                "`element.strut` has no `alfa`\n  help: did you mean `alpha`?",
            ),
            (&[(parameter, "parameter = ‸\"solver.rtoll\"")], UnknownKey, "did you mean `rtol`?"),
            (&[(parameter, "parameter = ‸\"solvr.rtol\"")], UnknownName, "did you mean solver.rtol?"),
            (&[(parameter, "parameter = ‸\"element..alpha\"")], BadName, "is not a path"),
            (&[(parameter, "parameter = ‸\"element.strut\"")], WrongType, "leads to a whole table"),
            (
                &[(parameter, "parameter = ‸\"robot.body.forearm.com.x\"")],
                UnknownName,
                "components count from 0: 0 to 2",
            ),
            (&[(parameter, "parameter = ‸\"element.strut.name\"")], Rule, "cannot be swept"),
            (&[(parameter, "parameter = ‸\"title\"")], Rule, "cannot be swept"),
            (&[(parameter, "parameter = ‸3")], WrongType, "a path or an array of paths"),
            (
                &[
                    (parameter, ""),
                    (
                        "[[sweep]]                                 # several",
                        "‸[[sweep]]                                 # several",
                    ),
                ],
                Missing,
                "[[sweep]] 1 has no `parameter`",
            ),
            (
                &[
                    (values, ""),
                    (
                        "[[sweep]]                                 # several",
                        "‸[[sweep]]                                 # several",
                    ),
                ],
                Missing,
                "[[sweep]] 1 has no `values`",
            ),
            (&[(values, "values = ‸[]")], Missing, "is empty"),
            (&[(values, "values = [0.1, ‸nan]")], OutOfRange, "not a finite number"),
            (&[(values, "values = [0.1, ‸1.5, 0.3]")], OutOfRange, "is 1.5, outside 0 … 1"),
            (&[(values, "values = [0.1, \"‸x\"]")], BadQuantity, "does not start with a number"),
            (&[(values, "values = ‸{ from = 0.1, to = 2, count = 5 }")], OutOfRange, "outside 0 … 1"),
            (
                &[(values, "values = { from = 0.1, to = 1, count = ‸1000000000 }")],
                TooLarge,
                "is 1000000000, outside 2 … 10000000",
            ),
            (
                &[(values, "values = { from = 0.1, to = 1, count = ‸99999999999999999999 }")],
                TooLarge,
                "outside 2 … 10000000",
            ),
            (&[(values, "values = { from = 0.1, to = 1, count = ‸1 }")], OutOfRange, "outside 2 … 10000000"),
            (
                &[(values, "values = ‸{ from = 0, to = 1, count = 3, scale = \"log\" }")],
                OutOfRange,
                "no logarithmic scale",
            ),
            (
                &[(values, "values = { from = 0, to = 1, count = 3, scale = ‸\"cubic\" }")],
                UnknownName,
                "write \"linear\" or \"log\"",
            ),
            (&[(values, "values = ‸{ from = 0, to = \"1 m\", count = 3 }")], Rule, "both ends in one unit"),
            (&[(values, "values = { from = ‸inf, to = 1, count = 3 }")], OutOfRange, "not a finite number"),
            (&[(values, "‸from = 1\nto = 2\ncount = 3")], UnknownKey, "write values = { from"),
            (
                &[("[[figure]]", &second.replace("[[sweep]]", "‸[[sweep]]"))],
                TooLarge,
                "a grid of 12000000 cases; at most 10000000 are run",
            ),
            (
                &[(
                    "[[figure]]",
                    "[[sweep]]\nparameter = ‸\"element.strut.parameters.alpha\"\nvalues = [1]\n[[figure]]",
                )],
                Rule,
                "is swept together with",
            ),
            (
                &[("x = \"t\" ", "where = { \"element.strut.alpha\" = ‸0.4 } ")],
                UnknownName,
                "swept values: 0.1, 0.3, 0.5, 0.7, 0.9 and 1.0",
            ),
            (&[("x = \"t\" ", "where = { ‸\"element.strut.E_d\" = 50 } ")], UnknownName, "not swept"),
        ],
    );
}

#[test]
fn a_byte_order_mark_and_other_line_ends_change_nothing() {
    let text = edited(EXAMPLE, &[("title = \"Thermo", "titel = \"Thermo")]);
    let plain = refusals(&text);
    let windows = refusals(&format!("\u{feff}{}", text.replace('\n', "\r\n")));
    let places = |refusals: &springpot_scenario::Refusals| -> Vec<(usize, usize, String)> {
        refusals.iter().map(|refusal| (refusal.line, refusal.column, refusal.message.clone())).collect()
    };
    assert_eq!(places(&windows), places(&plain));
    assert_eq!(places(&plain)[0].1, 1);
}

#[test]
fn a_sweep_keeps_the_columns() {
    let text = edited(
        EXAMPLE,
        &[
            ("parameter = \"element.strut.alpha\"", "parameter = \"element.strut.law\""),
            ("values = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0]", "values = [\"thermoviscoelastic\", \"spring\"]"),
        ],
    );
    let shown = refusals(&text).to_string();
    assert!(shown.contains("law \"spring\""), "{shown}");
}

#[test]
fn csv_signals_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.csv"), "t,q1,q2,q3\n0,0,0,0\n1,1,1,1\n9.5,2,2,2\n").unwrap();
    std::fs::write(folder.path().join("some.csv"), "t,q1,qq2,T\n0,0,0,25\n5,0,0,25\n10,2,2,25\n").unwrap();
    let plan = |edits: &[(&str, &str)]| {
        let (text, line, column) = marked(&edited(&single(), edits));
        let scenario = Scenario::parse(&text, "arm.toml", folder.path()).unwrap();
        let refusals = scenario.cases(&crate::support::catalog()).map(|cases| cases.len()).unwrap_err();
        let refusal = refusals.first().unwrap();
        assert_eq!((refusal.line, refusal.column), (line, column), "{refusals}");
        refusals.to_string()
    };
    for (edits, words) in [
        ((JOINTS, "csv = ‸\"short.csv\""), "covers t from 0 s to 9.5 s, but the run needs 0 s to 10 s"),
        ((JOINTS, "csv = ‸\"some.csv\""), "leaves out the columns q2, q3"),
        ((JOINTS, "csv = ‸\"none.csv\""), "cannot be read"),
        (("T = \"25 degC\"", "T = { csv = \"some.csv\", column = ‸\"TT\" }"), "did you mean `T`?"),
        (("T = \"25 degC\"", "T = ‸{ csv = \"some.csv\", column = \"T\" }"), "25 K? write unit = \"degC\""),
        (("T = \"25 degC\"", "T = ‸{ csv = \"some.csv\" }"), "has no `column`"),
    ] {
        let shown = plan(&[edits]);
        assert!(shown.contains(words), "{words:?} is not in\n{shown}");
    }
}

#[test]
fn broken_texts_are_refused_where_they_break() {
    let refuse = |text: &str| crate::support::parse(text).map(|_| ()).unwrap_err();
    for (text, words) in [
        ("title = \"a\"\ntitle ‸= \"b\"", ""),
        ("a = ‸", "not TOML"),
        ("[robot\n", "not TOML"),
        ("x = [1, 2", "not TOML"),
        ("= 3", "not TOML"),
    ] {
        let refusals = refuse(&text.replace('‸', ""));
        assert_eq!(refusals.first().unwrap().kind, Syntax, "{text}");
        assert!(refusals.to_string().contains(words), "{text}: {refusals}");
    }
    let twice = refuse("title = \"a\"\ntitle = \"b\"");
    assert_eq!((twice.first().unwrap().line, twice.first().unwrap().column), (2, 1), "{twice}");
    assert!(twice.to_string().contains("duplicate key"));
}

#[test]
fn deep_and_huge_texts_are_refused() {
    let refuse = |text: &str| crate::support::parse(text).map(|_| ()).unwrap_err().to_string();
    assert!(refuse(&format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000))).contains("recursion"));
    assert!(refuse(&format!("a = {}1{}", "[".repeat(60), "]".repeat(60))).contains("more than 24 levels deep"));
    assert!(refuse(&format!("{}a = 1", "a.".repeat(100_000))).contains("recursion"));
    let dotted = "a.".repeat(70) + "a";
    let inline = format!("{} = {{", dotted).repeat(79) + &format!("{dotted} = 1") + &"}".repeat(79);
    assert!(refuse(&inline).contains("levels deep"));
    assert!(refuse(&" ".repeat(5 << 20)).contains("larger than 4 MiB"));
    let many = (0..10_001).map(|i| format!("k{i} = 1\n")).collect::<String>();
    assert!(refuse(&many).contains("a table of 10001 keys"));
}

#[test]
fn too_many_bodies_and_elements_are_refused() {
    let bodies = (0..1001)
        .map(|i| format!("[[robot.body]]\nname = \"b{i}\"\njoint = {{ name = \"j{i}\", kind = \"revolute\", axis = [0, 0, 1] }}\nmass = 1\n"))
        .collect::<String>();
    assert!(refusals(&bodies).to_string().contains("holds 1001 bodies; at most 1000 are taken"));
    let elements = format!("{}\n{}", single(), "[[element]]\n".repeat(10_001));
    assert!(refusals(&elements).to_string().contains("holds 10002 elements; at most 10000"));
}

#[test]
fn a_robot_that_cannot_move_is_refused() {
    let text = single()
        .replace("kind = \"revolute\", axis = [0, 0, 1],", "kind = \"fixed\",")
        .replace("kind = \"revolute\", axis = [0, 1, 0],", "kind = \"fixed\",");
    assert!(refusals(&text).to_string().contains("[robot] has no joint that moves"));
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| Scenario::read(folder.path().join(name)).map(|_| ()).unwrap_err();
    assert!(read("none.toml").to_string().contains("none.toml:1:1: cannot be opened"));
    assert!(read("").to_string().contains("cannot be read"));
    std::fs::write(folder.path().join("latin.toml"), b"title = \"a\"\nx = \"\xe4\"").unwrap();
    let latin = read("latin.toml");
    assert_eq!((latin.first().unwrap().line, latin.first().unwrap().column), (2, 6));
    assert!(latin.to_string().contains("not UTF-8"));
    std::fs::write(folder.path().join("large.toml"), vec![b' '; 5 << 20]).unwrap();
    assert!(read("large.toml").to_string().contains("larger than 4 MiB"));
}
