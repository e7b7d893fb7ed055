//! `export`: recordings and models of a run, read by other means than those that wrote them.

use crate::support::Place;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// Quotes, tags and lines, in names that URDF files may have.
const HOSTILE: &str = r#"<script>"'\#"#;

/// A mass that falls past a mark.
const FALLS: &str = r#"
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [0, 0, 1] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "springpot"
parameters = { c = 50, alpha = 0.5 }
[motion]
kind = "forward"
start = { q = { x = 0.1 } }
[time]
end = 0.4
output_step = 0.03
[[event]]
name = "falls"
when = "q.x - 0.05"
"#;

/// Little-endian CDR, read field after field.
struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cdr<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.at = self.at.next_multiple_of(N);
        let taken = self.bytes[self.at..self.at + N].try_into().unwrap();
        self.at += N;
        taken
    }

    fn u32(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }

    fn string(&mut self) -> String {
        let length = self.u32();
        let text = String::from_utf8(self.bytes[self.at..self.at + length - 1].to_vec()).unwrap();
        assert_eq!(self.bytes[self.at + length - 1], 0);
        self.at += length;
        text
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn numbers(&mut self) -> Vec<f64> {
        let length = self.u32();
        (0..length).map(|_| self.f64()).collect()
    }

    /// Time in ns, and the frame.
    fn header(&mut self) -> (u64, String) {
        let (seconds, nanoseconds) = (self.u32() as u64, self.u32() as u64);
        (1_000_000_000 * seconds + nanoseconds, self.string())
    }
}

/// Messages by topic: time and bytes behind their head.
fn messages(file: &[u8]) -> BTreeMap<String, Vec<(u64, Vec<u8>)>> {
    let mut messages: BTreeMap<String, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    for message in mcap::MessageStream::new(file).unwrap().map(Result::unwrap) {
        assert_eq!((&message.data[..4], message.log_time), (&[0, 1, 0, 0][..], message.publish_time));
        assert_eq!(message.channel.message_encoding, "cdr");
        assert_eq!(message.channel.schema.as_ref().unwrap().encoding, "ros2msg");
        let own = messages.entry(message.channel.topic.clone()).or_default();
        assert_eq!(message.sequence as usize, own.len());
        own.push((message.log_time, message.data[4..].to_vec()));
    }
    messages
}

fn metadata(file: &[u8], name: &str) -> BTreeMap<String, String> {
    let summary = mcap::Summary::read(file).unwrap().unwrap();
    let index = summary.metadata_indexes.iter().find(|index| index.name == name).unwrap();
    mcap::read::metadata(file, index).unwrap().metadata
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn a_recording_has_every_row_to_the_bit() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--no-figures", "--quiet"]);
    assert_eq!(place.done(&["export", "results/arm", "a.mcap"]).stdout, "a.mcap\n");
    let file = fs::read(place.path("a.mcap")).unwrap();
    let (all, table) = (messages(&file), place.table("results/arm/results.csv"));
    let topics: Vec<&str> = all.keys().map(String::as_str).collect();
    assert_eq!(topics, ["/columns", "/elements/damper", "/gripper", "/joint_states", "/tf"]);
    assert!(all.values().all(|of| of.len() == table.rows.len()));
    let columns = ["q1", "x"].map(|joint| ["q", "v", "tau"].map(|what| table.numbers(&format!("{what}.{joint}"))));
    let (t, force, x) = (table.numbers("t"), table.numbers("damper.force"), table.numbers("gripper.x"));
    let places = metadata(&file, "springpot.columns");
    assert_eq!(places["damper.force"], "/elements/damper force");
    // Every column is somewhere.
    assert!(table.header.iter().all(|column| places.contains_key(column)));
    for (k, (time, bytes)) in all["/joint_states"].iter().enumerate() {
        let mut cdr = Cdr { bytes, at: 0 };
        assert_eq!((cdr.header(), *time), ((*time, String::new()), (t[k] * 1e9).round() as u64));
        assert_eq!((cdr.u32(), cdr.string(), cdr.string()), (2, "q1".to_owned(), "x".to_owned()));
        for what in 0..3 {
            assert_eq!(bits(&cdr.numbers()), bits(&[columns[0][what][k], columns[1][what][k]]));
        }
        assert_eq!(cdr.at, bytes.len());
    }
    for (k, (_, bytes)) in all["/gripper"].iter().enumerate() {
        let mut cdr = Cdr { bytes, at: 0 };
        assert_eq!((cdr.header().1, cdr.f64().to_bits()), ("world".to_owned(), x[k].to_bits()));
    }
    let schema = mcap::Summary::read(&file).unwrap().unwrap();
    let schema = schema.schemas.values().find(|schema| schema.name == "springpot_msgs/msg/Damper").unwrap();
    let text = String::from_utf8(schema.data.to_vec()).unwrap();
    assert!(text.contains("# damper.force, N: ") && text.contains("\nfloat64 force\n"), "{text}");
    let fields: Vec<&str> =
        text.split("====").next().unwrap().lines().filter(|line| line.starts_with("float64")).collect();
    let at = fields.iter().position(|field| *field == "float64 force").unwrap();
    for (k, (_, bytes)) in all["/elements/damper"].iter().enumerate() {
        let mut cdr = Cdr { bytes, at: 0 };
        cdr.header();
        let numbers: Vec<f64> = fields.iter().map(|_| cdr.f64()).collect();
        assert_eq!((numbers[at].to_bits(), cdr.at), (force[k].to_bits(), bytes.len()));
    }
    // The same run gives the same bytes.
    place.done(&["export", "results/arm", "b.mcap"]);
    assert!(fs::read(place.path("b.mcap")).unwrap() == file);
}

#[test]
fn events_stand_behind_their_rows() {
    let place = Place::new();
    place.write("falls.toml", FALLS);
    place.done(&["run", "falls.toml", "--no-figures", "--quiet"]);
    place.done(&["export", "results/falls", "a.mcap"]);
    let events = place.table("results/falls/events.csv");
    let file = fs::read(place.path("a.mcap")).unwrap();
    let mut all = messages(&file);
    let found: Vec<(u64, String)> = all
        .remove("/events")
        .unwrap()
        .into_iter()
        .map(|(time, bytes)| {
            let mut cdr = Cdr { bytes: &bytes, at: 0 };
            assert_eq!(cdr.header().0, time);
            (time, cdr.string())
        })
        .collect();
    let told = events.numbers("t").into_iter().zip(events.texts(&events.header[0]));
    let told: Vec<(u64, String)> = told.map(|(t, name)| ((t * 1e9).round() as u64, name.to_owned())).collect();
    assert!(!told.is_empty() && found == told, "{found:?} {told:?}");
}

#[test]
fn every_format_of_rows_gives_the_same_files() {
    let place = Place::new();
    let mut files: Vec<Vec<Vec<u8>>> = Vec::new();
    for format in ["csv", "parquet", "npz"] {
        let out = format!("{format}/arm");
        let sweep = "element.damper.alpha=0.3,0.6";
        place.done(&[
            "run",
            "arm.toml",
            "--format",
            format,
            "--out",
            &out,
            "--sweep",
            sweep,
            "--quiet",
            "--no-figures",
        ]);
        let endings = ENDINGS.map(|ending| {
            let file = format!("{format}{ending}");
            let ended = place.done(&["export", &out, &file, "--case", "1"]);
            assert_eq!((ended.stdout, ended.stderr), (format!("{file}\n"), String::new()));
            fs::read(place.path(&file)).unwrap()
        });
        files.push(endings.into());
    }
    assert!(files[0] == files[1] && files[0] == files[2]);
    assert_eq!(metadata(&files[0][0], "springpot")["parameter element.damper.alpha"], "0.6");
    assert_eq!(metadata(&files[0][0], "springpot")["case"], "1");
}

#[test]
fn of_several_cases_the_first_is_written_and_a_note_says_so() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--sweep", "element.damper.alpha=0.3,0.6", "--quiet", "--no-figures"]);
    let ended = place.done(&["export", "results/arm", "a.mcap"]);
    assert_eq!(ended.stdout, "a.mcap\n");
    assert!(ended.stderr.starts_with("note: case 0 of 2") && ended.stderr.contains("--case K"), "{}", ended.stderr);
    place.done(&["export", "results/arm", "b.mcap", "--case", "0"]);
    assert!(fs::read(place.path("a.mcap")).unwrap() == fs::read(place.path("b.mcap")).unwrap());
}

#[test]
fn what_cannot_be_exported_is_refused_and_leaves_no_file() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--quiet", "--no-figures"]);
    let refused = |arguments: &[&str], code: i32, said: &[&str]| {
        let ended = place.springpot(&[&["export"], arguments].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(code), ""), "{arguments:?}: {}", ended.stderr);
        assert!(said.iter().all(|said| ended.stderr.contains(said)), "{arguments:?}: {}", ended.stderr);
    };
    for file in ["a.bag", "mcap", "a", ".mcap", "a.mcap.gz"] {
        refused(&["results/arm", file], 2, &[&ENDINGS.join(", ")]);
    }
    refused(&["results/none", "a.mcap"], 2, &["there is no such folder", "name the folder"]);
    refused(&[".", "a.mcap"], 2, &["no run.json", "name the folder"]);
    refused(&["results/arm", "a.mcap", "--case", "3"], 2, &["case 3 has no row", "counted from 0"]);
    refused(&["results/arm", "none/a.mcap"], 1, &["none/a.mcap cannot be written"]);
    fs::create_dir(place.path("folder.mcap")).unwrap();
    refused(&["results/arm", "folder.mcap"], 1, &["folder.mcap cannot be written"]);
    let run = place.read("results/arm/run.json");
    let mut record: Value = serde_json::from_str(&run).unwrap();
    record["scenes"] = Value::Null;
    record.as_object_mut().unwrap().remove("scenes");
    place.write("results/arm/run.json", record.to_string());
    refused(&["results/arm", "a.mcap"], 2, &["an earlier version wrote it", "run the scenario again"]);
    place.write("results/arm/run.json", run.replace("\"rows\": ", "\"rows\": 0, \"were\": "));
    refused(&["results/arm", "a.mcap"], 2, &["no case of", "run.json says why"]);
    place.write("results/arm/run.json", &run);
    let rows = place.read("results/arm/results.csv");
    place.write("results/arm/results.csv", rows.replacen("0.3", "x", 1));
    refused(&["results/arm", "a.mcap"], 2, &["results.csv"]);
    place.write("results/arm/results.csv", rows.replacen("t,", "time,", 1));
    refused(&["results/arm", "a.mcap"], 2, &["no column `t`", "[output]"]);
    assert!(
        place.files(".").iter().all(|file| !file.contains(".mcap") && !file.contains(".part")),
        "{:?}",
        place.files(".")
    );
}

#[test]
fn hostile_names_stay_names() {
    let place = Place::new();
    let long = "x".repeat(100_000);
    let escaped = HOSTILE.replace('<', "&lt;").replace('"', "&quot;");
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<link name='{child}'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>
             <joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 1 0'/></joint>"
        )
    };
    let escaped = escaped.replace('\'', "&apos;");
    let robot = [
        "<robot name='r'><link name='world'/>",
        &joint(&escaped, "world", &escaped),
        &joint("j", &escaped, &long),
        "</robot>",
    ];
    place.write("r.urdf", robot.concat());
    place.write(
        "r.toml",
        format!("title = '''{HOSTILE}{long}'''\n[robot]\nurdf = 'r.urdf'\n[motion]\nkind = 'forward'\n[time]\nend = 0.1\noutput_step = 0.05\n"),
    );
    place.done(&["run", "r.toml", "--quiet", "--no-figures"]);
    for ending in ENDINGS {
        place.done(&["export", "results/r", &format!("a{ending}")]);
    }
    let file = fs::read(place.path("a.mcap")).unwrap();
    assert_eq!(metadata(&file, "springpot")["title"], format!("{HOSTILE}{long}"));
    let all = messages(&file);
    let mut cdr = Cdr { bytes: &all["/tf"][0].1, at: 0 };
    assert_eq!((cdr.u32(), cdr.header().1, cdr.string()), (2, "world".to_owned(), HOSTILE.to_owned()));
    (0..7).for_each(|_| _ = cdr.f64());
    assert_eq!((cdr.header().1, cdr.string()), (HOSTILE.to_owned(), "x".repeat(255)));
}

/// Numbers of an accessor of floats.
fn floats(model: &Value, buffer: &[u8], accessor: &Value) -> Vec<f64> {
    let accessor = &model["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &model["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
    assert!(from.is_multiple_of(4) && accessor["componentType"] == 5126);
    buffer[from..from + length].chunks(4).map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap()))).collect()
}

#[test]
fn a_model_moves_as_the_rows_do() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--no-figures", "--quiet"]);
    let ended = place.done(&["export", "results/arm", "a.glb"]);
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("a.glb\n", ""));
    place.done(&["export", "results/arm", "a.gltf"]);
    let (binary, table) = (fs::read(place.path("a.glb")).unwrap(), place.table("results/arm/results.csv"));
    let word = |at: usize| u32::from_le_bytes(binary[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&binary[..4], word(4), word(8), word(12) % 4), (&b"glTF"[..], 2, binary.len(), 0));
    let model: Value = serde_json::from_slice(&binary[20..20 + word(12)]).unwrap();
    let buffer = &binary[28 + word(12)..];
    let text: Value = serde_json::from_str(&place.read("a.gltf")).unwrap();
    assert_eq!((&text["accessors"], &text["nodes"]), (&model["accessors"], &model["nodes"]));
    assert_eq!(model["asset"]["extras"]["title"], "Damped arm");
    let animation = &model["animations"][0];
    let keys = |name: &str, path: &str| {
        let channel = animation["channels"].as_array().unwrap().iter().find(|channel| {
            let node = channel["target"]["node"].as_u64().unwrap() as usize;
            model["nodes"][node]["name"] == name && channel["target"]["path"] == path
        })?;
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        Some([&sampler["input"], &sampler["output"]].map(|accessor| floats(&model, buffer, accessor)))
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    // The arm turns about y where it is, the slide moves along x and does not turn.
    assert!(keys("arm", "translation").is_none() && keys("slide", "rotation").is_none());
    let ([t, turns], [_, shifts], [_, scales]) =
        (keys("arm", "rotation").unwrap(), keys("slide", "translation").unwrap(), keys("damper", "scale").unwrap());
    for k in 0..table.rows.len() {
        let number = |column: &str| table.numbers(column)[k];
        near(t[k], number("t"));
        near(turns[4 * k + 1], (number("q.q1") / 2.0).sin());
        near(shifts[3 * k], 0.4 + number("q.x"));
        near(scales[3 * k + 2], number("damper.length"));
    }
}

#[test]
fn of_many_rows_some_are_keyframes() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--no-figures", "--quiet", "--set", "time.output_step=0.0001"]);
    let ended = place.done(&["export", "results/arm", "a.gltf"]);
    assert!(ended.stderr.contains("note: one of 2 rows is a keyframe"), "{}", ended.stderr);
    let model: Value = serde_json::from_str(&place.read("a.gltf")).unwrap();
    let input = model["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
    // 3501 rows: every other one, the last among them.
    assert_eq!(model["accessors"][input]["count"], 1751);
    assert!((model["accessors"][input]["max"][0].as_f64().unwrap() - 0.35).abs() < 1e-7);
}

/// What there is.
const ENDINGS: [&str; 3] = [".mcap", ".glb", ".gltf"];
