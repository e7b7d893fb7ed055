//! The book is followed to the letter, and what it says of the program is what the program says.

mod evidence;
mod laws;
mod line;
mod links;
mod math;
mod page;
mod reader;
mod scenarios;
mod shown;

use page::{Page, summary};

/// A test for each page of the book, so that they run side by side.
macro_rules! pages {
    ($($test:ident: $path:literal;)*) => {
        $(
            #[test]
            fn $test() {
                let page = Page::open(concat!("docs/", $path));
                let done = reader::follow(&page).unwrap_or_else(|words| panic!("{words}"));
                println!("{}: {done:?}", page.name);
                let text = std::fs::read_to_string(format!("{}/{}", page::ROOT, page.name)).unwrap();
                assert_eq!(done.outputs, text.lines().filter(|line| line.starts_with("$ ")).count(), "{}", page.name);
            }
        )*

        #[test]
        fn every_page_is_followed() {
            assert_eq!(summary(), [$($path),*]);
        }
    };
}

pages! {
    introduction: "introduction.md";
    tutorial_command: "tutorial/command.md";
    tutorial_python: "tutorial/python.md";
    tutorial_rust: "tutorial/rust.md";
    own_robot: "how-to/own-robot.md";
    joints: "how-to/joints.md";
    own_material: "how-to/own-material.md";
    master: "how-to/master.md";
    how_to_fit: "how-to/fit.md";
    own_law: "how-to/own-law.md";
    own_controller: "how-to/own-controller.md";
    linear: "how-to/linear.md";
    look: "how-to/look.md";
    gradients: "how-to/gradients.md";
    papers: "how-to/papers.md";
    cluster: "how-to/cluster.md";
    engines: "ENGINES.md";
    scenario: "SCENARIO.md";
    scenario_values: "scenario/values.md";
    scenario_robot: "scenario/robot.md";
    scenario_urdf: "scenario/urdf.md";
    scenario_mjcf: "scenario/mjcf.md";
    scenario_element: "scenario/element.md";
    scenario_past: "scenario/past.md";
    scenario_heat: "scenario/heat.md";
    scenario_scheme: "scenario/scheme.md";
    scenario_prescribed: "scenario/prescribed.md";
    scenario_forward: "scenario/forward.md";
    scenario_feedback: "scenario/feedback.md";
    scenario_controller: "scenario/controller.md";
    scenario_events: "scenario/events.md";
    scenario_metrics: "scenario/metrics.md";
    scenario_time: "scenario/time.md";
    scenario_sweep: "scenario/sweep.md";
    scenario_sensitivity: "scenario/sensitivity.md";
    scenario_fit: "scenario/fit.md";
    scenario_design: "scenario/design.md";
    scenario_figures: "scenario/figures.md";
    scenario_results: "scenario/results.md";
    keys: "reference/keys.md";
    laws_overview: "laws/index.md";
    viscoelastic: "laws/viscoelastic.md";
    thermoviscoelastic: "laws/thermoviscoelastic.md";
    piezo: "laws/piezo.md";
    dampers: "laws/dampers.md";
    hysteresis: "laws/hysteresis.md";
    networks: "laws/networks.md";
    springpot: "theory/springpot.md";
    derivative: "theory/derivative.md";
    memory: "theory/memory.md";
    tolerance: "theory/tolerance.md";
    dynamics: "theory/dynamics.md";
    events_theory: "theory/events.md";
    commands: "COMMANDS.md";
    python_package: "reference/python.md";
    python_members: "reference/api.md";
    robots: "ROBOTS.md";
    notation: "NOTATION.md";
    validation: "VALIDATION.md";
    performance: "PERFORMANCE.md";
    positioning: "POSITIONING.md";
    literature: "LITERATURE.md";
    architecture: "ARCHITECTURE.md";
}

/// The README, whose commands build the program first.
#[test]
fn readme() {
    let mut page = Page::open("README.md");
    let mut left_out = 0;
    for block in &mut page.blocks {
        match block.info.as_str() {
            "toml" => block.info = "toml file=arm.toml".to_owned(),
            "console" => block.info = "bash".to_owned(),
            _ => {}
        }
        // What builds, waits for a browser, or needs another library.
        let elsewhere = |line: &String| {
            line.starts_with("cargo install ")
                || line.starts_with("./check.sh")
                || line.contains(" --serve")
                || line.contains(" fmu ")
        };
        let before = block.lines.len();
        block.lines.retain(|line| block.info != "sh" || !elsewhere(line));
        left_out += before - block.lines.len();
        for line in &mut block.lines {
            *line = line.replacen("cargo run --release -- ", "springpot ", 1);
        }
    }
    let done = reader::follow(&page).unwrap_or_else(|words| panic!("{words}"));
    println!("README.md: {done:?}");
    assert!(done.files == 1 && done.commands > 8 && left_out < 4, "{done:?}, {left_out} left out");
}

/// Programs in Rust are documentation tests of the library.
#[test]
fn every_program_is_a_test() {
    let library = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/src/lib.rs")).unwrap();
    let with = |path: &String| Page::open(&format!("docs/{path}")).blocks.iter().any(|block| block.info == "rust");
    let pages: Vec<String> = summary().into_iter().filter(with).collect();
    for path in &pages {
        assert!(
            library.contains(&format!("include_str!(\"../../../docs/{path}\")")),
            "docs/{path} is not in src/lib.rs"
        );
    }
    assert!(pages.len() >= 3);
}

/// A page with one thing that is wrong is refused by name and line.
#[test]
fn what_a_page_says_wrongly_is_found() {
    let page = "# Page\n\n```toml file=a/b.toml\nx = 1\n```\n\n```text\n$ springpot laws --from 'tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m'\n…\n  alpha = 0.185547\n…\n```\n\n```sh\nspringpot info testdata/multibody/panda.urdf > panda.txt\nmv panda.txt a/panda.txt\n```\n";
    let done = reader::follow(&Page::read("page.md", page)).unwrap();
    assert_eq!((done.files, done.commands, done.outputs), (1, 3, 1));
    for (right, wrong, place) in [
        ("0.185547", "0.185548", "page.md:8: "),
        ("springpot laws", "springpot law", "page.md:8: "),
        ("panda.urdf", "pandas.urdf", "page.md:15: "),
        ("mv panda.txt", "mv other.txt", "page.md:16: "),
        ("mv panda.txt a/panda.txt", "sed -n 1p panda.txt", "page.md:16: "),
        ("```sh", "```shell", "page.md:14: "),
    ] {
        let said = reader::follow(&Page::read("page.md", &page.replacen(right, wrong, 1))).unwrap_err();
        assert!(said.starts_with(place), "{wrong}: {said}");
    }
    // So is a number in a page of the book.
    let text = std::fs::read_to_string(format!("{}/docs/how-to/own-material.md", page::ROOT)).unwrap();
    let said = reader::follow(&Page::read("page.md", &text.replacen("0.290977 ± 0.016", "0.290978 ± 0.016", 1)));
    assert!(said.unwrap_err().contains("0.290978 ± 0.016"));
}
