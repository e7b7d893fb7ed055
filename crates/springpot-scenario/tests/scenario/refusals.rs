//! Every refusal of the format: message, line and column. The mark ‸ in an edit is where the refusal must point.

use crate::support::{assert_all_refused, assert_refused, edited, marked, refusals, single};
use springpot_scenario::RefusalKind::*;

const JOINTS: &str = "joints = { q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }";
const PRESCRIBED: &str = "kind = \"prescribed\"\njoints = { q1 = 0, q2 = \"0.1*sin(8*t)\", q3 = \"0.1*t\" }";
const PARAMETERS: &str = "parameters = { E_c = \"30 N/m\", E_kv = \"20 N/m\", E_d = \"50 N*s^alpha/m\", alpha = 0.5, a_kv = \"0.0007 m/K\" }";
const GRIPPER: &str = "[robot.gripper]\nbody = \"forearm\"                          # a link's name when the robot is a URDF\npoint = [0.4, 0, 0]\n";

#[test]
fn unknown_keys_are_refused_with_the_nearest_one() {
    assert_all_refused(
        &single(),
        &[
            (&[("rest_length = ", "‸rest_lenght = ")], UnknownKey, "did you mean `rest_length`?"),
            (
                &[("title = \"Thermo", "‸titel = \"Thermo")],
                UnknownKey,
                "unknown key `titel` in the scenario\n  help: did you mean `title`?",
            ),
            (&[("[solver]", "[‸solvr]")], UnknownKey, "did you mean `solver`?"),
            (&[("mass = 6.0", "mass = 6.0\n‸mas = 1")], UnknownKey, "unknown key `mas` in body \"column\""),
            (&[("origin = [0.5, 0, 0] }", "‸orign = [0.5, 0, 0] }")], UnknownKey, "did you mean `origin`?"),
            (&[("zz = 0.06, xz", "zz = 0.06, ‸xw")], UnknownKey, "unknown key `xw`"),
            (&[("output_step = ", "‸output_stp = ")], UnknownKey, "did you mean `output_step`?"),
            (&[("rtol = 1e-9       ", "‸rtoll = 1e-9")], UnknownKey, "did you mean `rtol`?"),
            (&[("point = [0.4, 0, 0]", "‸ponit = [0.4, 0, 0]")], UnknownKey, "did you mean `point`?"),
            (&[("x = \"t\" ", "‸xx = \"t\" ")], UnknownKey, "unknown key `xx` in [[figure]] 1"),
            (&[("# columns = [\"t\", \"strut.*\"]", "‸colums = [\"t\"]")], UnknownKey, "did you mean `columns`?"),
            (
                &[("T = \"25 degC\"", "T = { expresion = \"1\" }"), ("to = {", "‸to_ = {")],
                UnknownKey,
                "did you mean `to`?",
            ),
        ],
    );
}

#[test]
fn a_misspelled_key_is_not_also_missing() {
    let refusals = refusals(&edited(&single(), &[("rest_length = ", "rest_lenght = ")]));
    assert_eq!(refusals.len(), 1, "{refusals}");
    let refusals = self::refusals(&edited(&single(), &[("alpha = 0.5, a_kv", "alfa = 0.5, a_kv")]));
    assert_eq!(refusals.len(), 1, "{refusals}");
    let refusals = self::refusals(&edited(&single(), &[("\"0.1*sin(8*t)\", q3 =", "\"0.1*sin(8*t)\", q33 =")]));
    assert_eq!(refusals.len(), 1, "{refusals}");
}

#[test]
fn unknown_names_are_refused_with_the_nearest_one() {
    assert_all_refused(
        &single(),
        &[
            (
                &[("law = \"thermoviscoelastic\"", "law = ‸\"thermoviscoelastc\"")],
                UnknownName,
                "did you mean `thermoviscoelastic`?",
            ),
            (&[("from = { body = \"column\"", "from = { body = ‸\"colum\"")], UnknownName, "did you mean `column`?"),
            (
                &[("[robot.gripper]\nbody = \"forearm\"", "[robot.gripper]\nbody = ‸\"forarm\"")],
                UnknownName,
                "did you mean `forearm`?",
            ),
            (
                &[("name = \"forearm\"\n", "name = \"forearm\"\nparent = ‸\"colum\"\n")],
                UnknownName,
                "did you mean `column`?",
            ),
            (&[("q3 = \"0.1*t\" }", "‸q4 = \"0.1*t\" }")], UnknownKey, "unknown key `q4` in `joints` of [motion]"),
            (
                &[("inputs = { T =", "inputs = { ‸U = 1, T =")],
                UnknownKey,
                "unknown key `U` in `inputs` of element \"strut\"",
            ),
            (
                &[("parameters = { E_c =", "parameters = { ‸E_x = 1, E_c =")],
                UnknownKey,
                "unknown key `E_x` in `parameters`",
            ),
            (
                &[("derivative = \"riemann-liouville\"", "derivative = ‸\"rieman-liouville\"")],
                UnknownName,
                "did you mean `riemann-liouville`?",
            ),
            (
                &[("# scheme = \"expansion-2004(30)\"", "scheme = ‸\"grunwald\"  ")],
                UnknownName,
                "did you mean `grunwald-letnikov`?",
            ),
            (
                &[("# scheme = \"expansion-2004(30)\"", "scheme = ‸\"expansion-2004\" ")],
                UnknownName,
                "did you mean `expansion-2004(N)`?",
            ),
            (
                &[("# scheme = \"expansion-2004(30)\"", "scheme = ‸\"expansion-2008(100000)\" ")],
                OutOfRange,
                "must lie between 1 and 5000",
            ),
            (&[("kind = \"prescribed\"", "kind = ‸\"prescribd\"")], UnknownName, "did you mean `prescribed`?"),
            (
                &[("\"q3\", kind = \"revolute\"", "\"q3\", kind = ‸\"revolut\"")],
                UnknownName,
                "did you mean `revolute`?",
            ),
            (&[("\"0.1*sin(8*t)\"", "\"0.1*‸sn(8*t)\"")], BadQuantity, "sin"),
            (&[("\"0.1*sin(8*t)\"", "\"0.1*sin(8*‸x)\"")], BadQuantity, "unknown name `x`"),
            (&[("\"70 cm\"", "\"70 ‸cmm\"")], BadQuantity, "unknown unit `cmm`"),
            // Where escapes or signs of several bytes hide a place, the whole value is it.
            (&[("\"0.1*sin(8*t)\"", "‸\"0.1*ö*\\\"\\\"\\\"\\\"\"")], BadQuantity, "ö"),
            (&[("\"0.1*sin(8*t)\"", "‸\"€€€*sn(t)\\u00e9\"")], BadQuantity, "€"),
            (&[("x = \"t\" ", "kind = ‸\"curve\" ")], UnknownName, "did you mean `curves`?"),
            (&[("x = \"t\" ", "units = { \"strut.Q.q2\" = \"‸Nn\" } ")], BadQuantity, "unknown unit `Nn`"),
            (
                &[("x = \"t\" ", "where = { ‸\"element.strut.alpha\" = 0.5 } ")],
                UnknownName,
                "element.strut.alpha, which is not swept",
            ),
        ],
    );
}

#[test]
fn wrong_types_are_refused() {
    assert_all_refused(
        &single(),
        &[
            (
                &[("title = \"Thermoviscoelastic strut on a three-body robot\"", "title = ‸3")],
                WrongType,
                "`title` of the scenario must be a text, not the number 3",
            ),
            (
                &[("mass = 6.0", "mass = ‸true")],
                WrongType,
                "`mass` of body \"column\" must be a number or a quantity in kg, not the boolean true",
            ),
            (&[("com = [0.02, 0.0, 0.3]  ", "com = ‸[0.02, 0.0]  ")], WrongType, "has 2 entries"),
            (
                &[("com = [0.02, 0.0, 0.3]  ", "com = ‸0.3  ")],
                WrongType,
                "an array of three numbers or quantities in m, not the number 0.3",
            ),
            (&[("com = [0.02, 0.0, 0.3]  ", "com = [0.02, ‸[0], 0.3]  ")], WrongType, "not the array [0]"),
            (
                &[("inertia = { xx = 0.20, yy = 0.20, zz = 0.06, xz = 0.01 }", "inertia = ‸3")],
                WrongType,
                "must be a table",
            ),
            (
                &[(
                    "joint = { name = \"q2\", kind = \"revolute\", axis = [0, 1, 0], origin = [0, 0, 0.6] }",
                    "joint = ‸\"q2\"",
                )],
                WrongType,
                "must be a table",
            ),
            (
                &[("from = { body = \"column\", point = [0.14, -0.1, 0.08] }", "from = ‸\"column\"")],
                WrongType,
                "must be a table",
            ),
            (&[("law = \"thermoviscoelastic\"", "law = ‸7")], WrongType, "must be a text"),
            (&[(JOINTS, "joints = ‸[0, 0, 0]")], WrongType, "must be a table"),
            (&[("q1 = 0,", "q1 = ‸true,")], WrongType, "a number, a quantity, an expression of t or a table"),
            (&[("q1 = 0,", "q1 = ‸1979-05-27,")], WrongType, "not the date 1979-05-27"),
            (&[("end = \"10 s\"", "end = ‸[10]")], WrongType, "must be a number or a quantity in s"),
            (&[("rtol = 1e-9       ", "max_steps = ‸1.5")], WrongType, "must be a whole number"),
            (&[("y = [\"strut.Q.q2\"]", "y = ‸3")], WrongType, "name of a column"),
            (&[("y = [\"strut.Q.q2\"]", "y = [‸3]")], WrongType, "must be a text"),
            (
                &[(PRESCRIBED, "kind = \"gripper-path\"\nx = 1\ny = 0\nz = 0\nrpy = ‸[0, 0]")],
                WrongType,
                "roll, pitch, yaw",
            ),
            (&[("inputs = { T = \"25 degC\" }", "inputs = ‸25")], WrongType, "must be a table"),
        ],
    );
    let (text, line, column) = marked("element = ‸3\nrobot = 1\nmotion = 2\ntime = 3");
    let refusals = refusals(&text);
    assert!(refusals.iter().any(|refusal| refusal.message.contains("[robot] must be a table, not the number 1")));
    assert!(refusals.iter().any(|refusal| refusal.message.contains("[time] must be a table")), "{refusals}");
    assert_eq!((line, column), (1, 11));
}

#[test]
fn wrong_dimensions_are_refused() {
    assert_all_refused(
        &single(),
        &[
            (
                &[("mass = 6.0", "mass = \"6 ‸m\"")],
                BadQuantity,
                "`mass` of body \"column\": `m` does not fit: this place takes `kg`",
            ),
            (
                &[("\"70 cm\"", "\"70 ‸kg\"")],
                BadQuantity,
                "`rest_length` of element \"strut\": `kg` does not fit: this place takes `m`",
            ),
            (&[("E_c = \"30 N/m\"", "E_c = \"30 ‸N*m\"")], BadQuantity, "`E_c` of `parameters` of element \"strut\""),
            (&[("\"50 N*s^alpha/m\"", "\"50 ‸N*s/m\"")], BadQuantity, "N*s^alpha/m"),
            (&[("\"50 N*s^alpha/m\"", "\"50 N*s^‸beta/m\"")], BadQuantity, "`beta` is not a known exponent"),
            (&[("alpha = 0.5, a_kv", "alpha = \"0.5 ‸s\", a_kv")], BadQuantity, "pure number"),
            (&[("T = \"25 degC\"", "T = \"25 ‸V\"")], BadQuantity, "`T` of `inputs` of element \"strut\""),
            (
                &[("T = \"25 degC\"", "T = { expression = \"25\", unit = ‸\"V\" }")],
                BadQuantity,
                "another dimension than K",
            ),
            (
                &[("T = \"25 degC\"", "T = { expression = \"25\", unit = \"‸degX\" }")],
                BadQuantity,
                "unknown unit `degX`",
            ),
            (&[("end = \"10 s\"", "end = \"10 ‸m\"")], BadQuantity, "`end` of [time]"),
            (&[("q1 = 0,", "q1 = \"1 ‸m\",")], BadQuantity, "`q1` of `joints` of [motion]"),
            (
                &[("gravity = [0.0, 0.0, -9.81]", "gravity = [0.0, 0.0, \"9.81 ‸m/s\"]")],
                BadQuantity,
                "`gravity` of [robot]",
            ),
            (
                &[("origin = [0.5, 0, 0] }", "origin = [0.5, 0, 0], damping = \"1 ‸N*s/m\" }")],
                BadQuantity,
                "`damping` of the joint of body \"forearm\"",
            ),
            (&[("origin = [0.5, 0, 0] }", "origin = [0.5, 0, 0], friction = \"1 ‸N\" }")], BadQuantity, "N*m"),
            (&[("q2 = \"0.1*sin(8*t)\"", "q2 = \"2 ‸t\"")], BadQuantity, "`t` is no unit"),
            (&[("mass = 6.0", "mass = \"‸heavy\"")], BadQuantity, "does not start with a number"),
        ],
    );
}

#[test]
fn what_is_missing_is_refused() {
    assert_all_refused(
        &single(),
        &[
            (&[(JOINTS, "joints = ‸{ q2 = 0 }")], Missing, "leaves out the joints q1, q3"),
            (&[(JOINTS, "joints = ‸{}")], Missing, "leaves out the joints q1, q2, q3"),
            (
                &[(PRESCRIBED, "kind = \"prescribed\""), ("[motion]", "‸[motion]")],
                Missing,
                "write joints = { q1 = …, q2 = …, q3 = … } or csv",
            ),
            (&[(PRESCRIBED, ""), ("[motion]", "‸[motion]")], Missing, "[motion] has no `kind`"),
            (
                &[(PARAMETERS, "parameters = ‸{ alpha = 0.5, E_kv = 1 }")],
                Missing,
                "law \"thermoviscoelastic\" needs the parameters E_c, E_d and a_kv",
            ),
            (
                &[(PARAMETERS, ""), ("[[element]]", "‸[[element]]")],
                Missing,
                "needs the parameters E_c, E_kv, E_d, alpha and a_kv",
            ),
            (
                &[("inputs = { T = \"25 degC\" }", "inputs = ‸{}")],
                Missing,
                "needs the inputs T\n  help: T [K]: temperature",
            ),
            (&[("inputs = { T = \"25 degC\" }", ""), ("[[element]]", "‸[[element]]")], Missing, "needs the inputs T"),
            (
                &[("rest_length = \"70 cm\"", ""), ("[[element]]", "‸[[element]]")],
                Missing,
                "element \"strut\" has no `rest_length`",
            ),
            (&[("name = \"strut\"", ""), ("[[element]]", "‸[[element]]")], Missing, "element 1 has no `name`"),
            (
                &[("law = \"thermoviscoelastic\"", ""), ("[[element]]", "‸[[element]]")],
                Missing,
                "element \"strut\" has no `law`",
            ),
            (
                &[("from = { body = \"column\", point = [0.14, -0.1, 0.08] }", "from = ‸{ body = \"column\" }")],
                Missing,
                "has no `point`",
            ),
            (
                &[("mass = 2.0\n", ""), ("[[robot.body]]\nname = \"forearm\"", "‸[[robot.body]]\nname = \"forearm\"")],
                Missing,
                "body \"forearm\" has no `mass`",
            ),
            (
                &[(
                    "joint = { name = \"q3\", kind = \"revolute\", axis = [0, 1, 0],",
                    "joint = ‸{ name = \"q3\", kind = \"revolute\",",
                )],
                Missing,
                "has no `axis`",
            ),
            (&[("zz = 0.06, ", ""), ("inertia = { xx = 0.20", "inertia = ‸{ xx = 0.20")], Missing, "has no `zz`"),
            (&[("end = \"10 s\"", ""), ("[time]", "‸[time]")], Missing, "[time] has no `end`"),
            (
                &[("output_step = \"10 ms\"", ""), ("[time]", "‸[time]")],
                Missing,
                "write output_step = \"10 ms\" or output_times",
            ),
            (&[("y = [\"strut.Q.q2\"]", ""), ("[[figure]]", "‸[[figure]]")], Missing, "[[figure]] 1 has no `y`"),
            (&[("y = [\"strut.Q.q2\"]", "y = ‸[]")], Missing, "is empty"),
            (
                &[(PRESCRIBED, "kind = \"gripper-path\"\nx = 1\ny = 2"), ("[motion]", "‸[motion]")],
                Missing,
                "[motion] has no `z`",
            ),
            (
                &[(GRIPPER, ""), (PRESCRIBED, "kind = ‸\"gripper-path\"\nx = 1\ny = 0\nz = 0")],
                Missing,
                "the robot has none",
            ),
            (&[("T = \"25 degC\"", "T = ‸{ unit = \"K\" }")], Missing, "has no `expression`"),
            (&[("output_step = \"10 ms\"", "output_times = ‸[]")], Missing, "is empty"),
        ],
    );
}

#[test]
fn whole_sections_are_missed_together() {
    let refusals = refusals("‸".trim_matches('‸'));
    let messages: Vec<&str> = refusals.iter().map(|refusal| refusal.message.as_str()).collect();
    for section in ["robot", "motion", "time"] {
        let message = format!("the scenario has no `{section}`");
        assert!(messages.contains(&message.as_str()), "{messages:?}");
    }
    assert!(refusals.iter().all(|refusal| (refusal.line, refusal.column) == (1, 1)));
    let motion = refusals.iter().find(|refusal| refusal.message.contains("`motion`")).unwrap();
    let help = "write [motion] with kind = \"prescribed\", \"gripper-path\" or \"forward\"";
    assert_eq!(motion.help.as_deref(), Some(help));
}

#[test]
fn values_outside_their_range_are_refused() {
    assert_all_refused(
        &single(),
        &[
            (&[("alpha = 0.5, a_kv", "alpha = ‸1.5, a_kv")], OutOfRange, "is 1.5, outside 0 … 1"),
            (&[("alpha = 0.5, a_kv", "alpha = ‸-0.1, a_kv")], OutOfRange, "is -0.1, outside 0 … 1"),
            (&[("axis = [0, 0, 1]", "axis = ‸[0, 0, 0]")], OutOfRange, "is [0, 0, 0], which has no direction"),
            (&[("end = \"10 s\"", "end = ‸\"0 s\"")], OutOfRange, "is 0 s, but must be positive"),
            (&[("end = \"10 s\"", "end = ‸-1")], OutOfRange, "is -1, but must be positive"),
            (
                &[("output_step = \"10 ms\"", "output_step = ‸0")],
                OutOfRange,
                "`output_step` of [time] is 0, but must be positive",
            ),
            (&[("output_step = \"10 ms\"", "output_step = ‸\"-1 ms\"")], OutOfRange, "is -1 ms, but must be positive"),
            (
                &[("output_step = \"10 ms\"", "output_step = ‸\"1 ns\"")],
                TooLarge,
                "makes 10000000000 rows; at most 20000000 are written",
            ),
            (&[("output_step = \"10 ms\"", "output_times = [0, ‸11]")], OutOfRange, "outside 0 … 10 s"),
            (&[("output_step = \"10 ms\"", "output_times = [‸-1]")], OutOfRange, "outside 0 … 10 s"),
            (&[("output_step = \"10 ms\"", "output_times = [1, ‸1]")], Rule, "increasing order"),
            (
                &[("output_step = \"10 ms\"", "output_times = { from = 0.1, to = ‸\"20 s\", count = 5 }")],
                OutOfRange,
                "is 20 s, beyond the end at 10 s",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = ‸{ from = 0, to = 1, count = 5, scale = \"log\" }")],
                OutOfRange,
                "runs from 0 to 1, which has no logarithmic scale",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = { from = ‸-1, to = 1, count = 5 }")],
                OutOfRange,
                "is -1, before the motion starts",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = ‸{ from = 2, to = 1, count = 5 }")],
                OutOfRange,
                "runs from 2 s to 1 s",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = ‸{ from = 0.1, to = 1 }")],
                Missing,
                "write from, to and count",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = { from = 0.1, to = 1, count = ‸1 }")],
                OutOfRange,
                "outside 2 … 20000000",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = { from = 0.1, to = 1, count = 3, scale = ‸\"lin\" }")],
                UnknownName,
                "is \"lin\", which is no scale",
            ),
            (
                &[("output_step = \"10 ms\"", "output_times = ‸{ from = 1, to = 1.0000000000000002, count = 9 }")],
                OutOfRange,
                "too close to one another to be told apart",
            ),
            (&[("mass = 6.0", "mass = ‸nan")], OutOfRange, "`mass` of body \"column\" is nan, not a finite number"),
            (&[("mass = 6.0", "mass = ‸inf")], OutOfRange, "is inf, not a finite number"),
            (&[("mass = 6.0", "mass = ‸-inf")], OutOfRange, "is -inf, not a finite number"),
            (&[("mass = 6.0", "mass = ‸1e999")], OutOfRange, "not a finite number"),
            (&[("com = [0.02, 0.0, 0.3]  ", "com = [0.02, ‸nan, 0.3]  ")], OutOfRange, "not a finite number"),
            (&[("T = \"25 degC\"", "T = ‸inf")], OutOfRange, "not a finite number"),
            (&[("q1 = 0,", "q1 = ‸nan,")], OutOfRange, "not a finite number"),
            (&[("q1 = 0,", "q1 = ‸\"1/t\",")], OutOfRange, "is not finite at t = 0 s"),
            (&[("q1 = 0,", "q1 = ‸\"sqrt(t)\",")], OutOfRange, "has a rate that is not finite at t = 0 s"),
            (&[("q1 = 0,", "q1 = ‸\"sqrt(5 - t)\",")], OutOfRange, "is not finite at t = "),
            (&[("alpha = 0.5, a_kv", "alpha = ‸nan, a_kv")], OutOfRange, "not a finite number"),
            (&[("end = \"10 s\"", "end = ‸inf")], OutOfRange, "not a finite number"),
            (&[("rtol = 1e-9       ", "rtol = ‸0")], OutOfRange, "`rtol` of [solver] is 0, outside 1e-13 … 0.1"),
            (&[("rtol = 1e-9       ", "rtol = ‸1")], OutOfRange, "outside 1e-13 … 0.1"),
            (&[("rtol = 1e-9       ", "atol = ‸0")], OutOfRange, "must be positive"),
            (&[("rtol = 1e-9       ", "memory_rtol = ‸1e-13")], OutOfRange, "outside 1e-12 … 0.1"),
            (&[("rtol = 1e-9       ", "first_step = ‸-1")], OutOfRange, "must be positive"),
            (&[("rtol = 1e-9       ", "max_steps = ‸0")], OutOfRange, "write a whole number from 1"),
            (&[("\"70 cm\"", "‸\"-70 cm\"")], OutOfRange, "is -70 cm, but a length is not negative"),
            (&[("T = \"25 degC\"", "T = ‸25")], OutOfRange, "25 K? write \"25 degC\""),
            (&[("T = \"25 degC\"", "T = ‸\"2000 K\"")], OutOfRange, "is 2000 K, outside 150 … 1500"),
            (
                &[("T = \"25 degC\"", "T = ‸\"25 + 5*sin(t)\"")],
                OutOfRange,
                "25 K? write { expression = \"25 + 5*sin(t)\", unit = \"degC\" }",
            ),
            (&[("a_kv = \"0.0007 m/K\"", "a_kv = \"0.0007 m/K\", T_ref = ‸20")], OutOfRange, "20 K? write \"20 degC\""),
        ],
    );
}

#[test]
fn rules_are_kept() {
    assert_all_refused(
        &single(),
        &[
            (
                &[(
                    "to = { body = \"forearm\", point = [-0.06, 0.1, 0.08] }",
                    "to = ‸{ body = \"column\", point = [0, 0, 0] }",
                )],
                Rule,
                "has both ends on \"column\": its length cannot change",
            ),
            (
                &[
                    (
                        "to = { body = \"forearm\", point = [-0.06, 0.1, 0.08] }",
                        "to = ‸{ body = \"upper_arm\", point = [0, 0, 0] }",
                    ),
                    ("name = \"q2\", kind = \"revolute\", axis = [0, 1, 0],", "name = \"q2\", kind = \"fixed\","),
                    ("q2 = \"0.1*sin(8*t)\", ", ""),
                ],
                Rule,
                "joins \"column\" and \"upper_arm\", which fixed joints hold together",
            ),
            (
                &[("name = \"upper_arm\"", "name = \"upper_arm\"\nparent = ‸\"forearm\"")],
                Rule,
                "is \"forearm\", a later body",
            ),
            (&[("name = \"upper_arm\"", "name = \"upper_arm\"\nparent = ‸\"upper_arm\"")], Rule, "the body itself"),
            (
                &[
                    ("[robot.gripper]\nbody = \"forearm\"", "[robot.gripper]\nbody = \"world\""),
                    ("[robot.gripper]", "‸[robot.gripper]"),
                ],
                Rule,
                "is on the world",
            ),
            (
                &[("name = \"q2\", kind = \"revolute\", axis", "name = \"q2\", kind = \"fixed\", ‸axis")],
                Rule,
                "a fixed joint does not move",
            ),
            (
                &[
                    ("name = \"q2\", kind = \"revolute\", axis = [0, 1, 0],", "name = \"q2\", kind = \"fixed\","),
                    ("q2 = \"0.1*sin", "‸q2 = \"0.1*sin"),
                ],
                Rule,
                "joint \"q2\" is fixed and has no coordinate",
            ),
            (&[("rtol = 1e-9       ", "‸method = \"radau\"")], Rule, "`method` of [solver] belongs to forward runs"),
            (&[("rtol = 1e-9       ", "‸step = 0.1")], Rule, "`step` of [solver] belongs to forward runs"),
            (
                &[(PRESCRIBED, "kind = \"forward\""), ("rtol = 1e-9       ", "method = ‸\"explicit\"")],
                Rule,
                "`method` is \"explicit\": the force of element \"strut\" hangs on the past",
            ),
            (
                &[
                    (PRESCRIBED, "kind = \"forward\""),
                    ("rtol = 1e-9       ", "method = \"explicit\"\nstep = ‸\"1 ms\""),
                ],
                Rule,
                "belongs to a fixed-step method; \"explicit\" chooses its steps",
            ),
            (
                &[(PRESCRIBED, "kind = \"prescribed\"\njoints = { q1 = 0, q2 = 0, q3 = 0 }\ncsv = ‸\"m.csv\"")],
                Rule,
                "stands beside `joints`",
            ),
            (
                &[("output_step = \"10 ms\"", "output_step = \"10 ms\"\noutput_times = ‸[0]\n")],
                Rule,
                "stands beside `output_step`",
            ),
            (
                &[("T = \"25 degC\"", "T = { expression = \"300\", csv = ‸\"a.csv\" }")],
                Rule,
                "stands beside `expression`",
            ),
            (&[("T = \"25 degC\"", "T = { expression = \"300\", column = ‸\"a\" }")], UnknownKey, "belongs to `csv`"),
            (
                &[
                    ("# scheme = \"expansion-2004(30)\"", "scheme = ‸\"fbdf-2\" "),
                    ("output_step = \"10 ms\"", "output_times = [0, 1, 10]"),
                ],
                Rule,
                "needs equal steps",
            ),
            (
                &[
                    ("# scheme = \"expansion-2004(30)\"", "scheme = ‸\"l1\" "),
                    ("output_step = \"10 ms\"", "output_times = [1, 10]"),
                ],
                Rule,
                "the first of `output_times` must be 0",
            ),
            (&[("x = \"t\" ", "kind = \"robot\"\nx = ‸\"t\"")], Rule, "has no meaning where kind = \"robot\""),
            (
                &[
                    ("law = \"thermoviscoelastic\"", "law = \"spring\""),
                    (PARAMETERS, "parameters = { k = ‸0 }"),
                    ("inputs = { T = \"25 degC\" }", ""),
                ],
                Rule,
                "law \"spring\" needs k > 0",
            ),
        ],
    );
}

#[test]
fn names_keep_their_rules() {
    assert_all_refused(
        &single(),
        &[
            (&[("name = \"strut\"", "name = ‸\"1strut\"")], BadName, "is \"1strut\", which is not a name"),
            (&[("name = \"strut\"", "name = ‸\"a.b\"")], BadName, "a name starts with a letter or _"),
            (&[("name = \"strut\"", "name = ‸\"\"")], BadName, "which is not a name"),
            (&[("name = \"strut\"", "name = ‸\"tau\"")], BadName, "may not be called t, q, v, a, tau, energy, gripper"),
            (&[("name = \"strut\"", "name = ‸\"q\"")], BadName, "which the columns of the results use"),
            (&[("name = \"upper_arm\"", "name = ‸\"world\"")], BadName, "is \"world\", which is taken"),
            (&[("name = \"upper_arm\"", "name = ‸\"column\"")], BadName, "is \"column\", which is taken on line 6"),
            (&[("name = \"q2\"", "name = ‸\"q1\"")], BadName, "is \"q1\", which is taken on line 7"),
            (&[("name = \"q2\"", "name = ‸\"q 1\"")], BadName, "which is not a name"),
            (&[("name = \"upper_arm\"", "name = ‸\"upper arm\"")], BadName, "which is not a name"),
            (&[("name = \"order\"", "name = ‸\"a/b\"")], BadName, "which is not a file name"),
            (&[("name = \"order\"", "name = ‸\"..\"")], BadName, "which is not a file name"),
            (
                &[("[output]", "‸[[figure]]\nname = \"ORDER\"\ny = \"t\"\n[output]")],
                BadName,
                "the name is taken on line ",
            ),
            (&[("[output]", "‸[[element]]\nname = \"strut\"\n[output]")], Missing, "has no `from`"),
        ],
    );
    let element = "[[element]]\nname = ‸\"strut\"\nlaw = \"spring\"\nparameters = { k = 1 }\nrest_length = 1\n\
                   from = { body = \"world\", point = [0, 0, 0] }\nto = { body = \"forearm\", point = [0, 0, 0] }\n[output]";
    assert_refused(&single(), &(&[("[output]", element)], BadName, "is \"strut\", which is taken on line"));
}

#[test]
fn motions_that_follow_from_forces() {
    let text = single();
    let start = text.find("kind = \"prescribed\"").unwrap();
    let line_end = text[start..].find("joints =").unwrap() + start;
    let end = text[line_end..].find('\n').unwrap() + line_end;
    let forward = |keys: &str| format!("{}kind = \"forward\"\n{keys}{}", &text[..start], &text[end..]);
    let told = |keys: &str| refusals(&forward(keys)).to_string();
    for (keys, words) in [
        ("torque = { q9 = 1 }", "unknown key `q9`"),
        ("torque = { q1 = \"5 N\" }", "N*m"),
        ("locked = [\"q9\"]", "names no joint: \"q9\""),
        ("locked = [\"q1\"]\ntorque = { q1 = 1 }", "joint \"q1\" in more than one way: torque, locked"),
        ("start = { q = { q1 = \"5 m\" } }", "rad"),
        ("start = { w = {} }", "unknown key `w`"),
        ("joints = { q1 = 0 }", "unknown key `joints`"),
    ] {
        let told = told(keys);
        assert!(told.contains(words), "{keys}: {told}");
    }
}

#[test]
fn a_robot_that_moves_by_itself_takes_other_keys() {
    assert_refused(
        &single(),
        &(
            &[("kind = \"prescribed\"\njoints", "kind = \"forward\"\n‸joints")],
            UnknownKey,
            "there is kind, start, torque, prescribed, locked and controller",
        ),
    );
}

#[test]
fn mistakes_are_collected() {
    let text = edited(
        &single(),
        &[
            ("mass = 6.0", "mass = true"),
            ("mass = 2.0", "mass = \"2 m\""),
            ("end = \"10 s\"", "end = 0"),
            ("rtol = 1e-9       ", "rtoll = 1e-9"),
        ],
    );
    let refusals = refusals(&text);
    assert_eq!(refusals.len(), 4, "{refusals}");
    let lines: Vec<usize> = refusals.iter().map(|refusal| refusal.line).collect();
    assert!(lines.is_sorted(), "{lines:?}");
}

#[test]
fn refusals_do_not_grow_without_bound() {
    let keys = (0..5000).map(|i| format!("k{i} = 1\n")).collect::<String>();
    let refusals = refusals(&keys);
    assert!(refusals.len() <= 50, "{}", refusals.len());
}

#[test]
fn a_million_mistakes_are_answered_at_once() {
    let list = "1,".repeat(900_000);
    let refusals = refusals(&edited(&single(), &[("y = [\"strut.Q.q2\"]", &format!("y = [{list}]"))]));
    assert_eq!(refusals.len(), 50);
    let elements = "[[element]]\nfrom = { body = \"nowhere\", point = [0, 0, nan] }\n".repeat(9_000);
    assert_eq!(crate::support::refusals(&format!("{}\n{elements}", single())).len(), 50);
}

#[test]
fn robots_that_are_not_physical_are_refused() {
    assert_all_refused(
        &single(),
        &[
            (&[("mass = 6.0", "mass = ‸-6.0")], Rule, "mass of body \"column\" is -6"),
            (
                &[("origin = [0.5, 0, 0] }", "origin = [0.5, 0, 0], damping = ‸-1 }")],
                Rule,
                "joint.damping of body \"forearm\" is -1",
            ),
            (&[("inertia = { xx = 0.01,", "inertia = ‸{ xx = -0.01,")], Rule, "inertia of body \"upper_arm\""),
            (
                &[("inertia = { xx = 0.20, yy = 0.20,", "inertia = ‸{ xx = 0.20, yy = 2,")],
                Rule,
                "inertia of body \"column\"",
            ),
            (
                &[
                    ("mass = 2.0", "mass = ‸0"),
                    ("com = [0.18, -0.01, 0.01]", ""),
                    ("inertia = { xx = 0.006, yy = 0.03, zz = 0.03, xz = -0.001, yz = 0.0004 }", ""),
                ],
                Rule,
                "the mass matrix is singular at joint \"q3\"",
            ),
        ],
    );
}
