//! Rows and threads change nothing.

use springpot::law::Catalog;
use springpot_run::sweep::{self, Layout, Options, Progress};
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::{Folder, Targets};
use springpot_scenario::Scenario;
use std::sync::atomic::AtomicBool;

#[test]
fn a_sweep_gives_the_same_bytes_for_any_number_of_threads() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let shipped = std::fs::read_to_string(format!("{folder}/thermoviscoelastic_temperature.toml")).unwrap();
    // Everything up to the motion: the three-body arm and its strut.
    let text = shipped.split("[motion]").next().unwrap().to_owned()
        + "[motion]\nkind = \"forward\"\nstart = { q = { q2 = 0.2 } }\n[motion.torque]\nq2 = 0\n\
           [time]\nend = 0.5\noutput_step = 0.05\n[solver]\nrtol = 1e-7\n\
           [[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.1, 0.3, 0.5, 0.7, 0.9, 1.0]\n\
           [[sweep]]\nparameter = \"motion.torque.q2\"\nvalues = [0, \"abs(sin(9*t))\", \"2*sin(5*t)\"]\n";
    let cases = Scenario::parse(&text, "arm.toml", folder).unwrap().cases(&Catalog::standard()).unwrap();
    assert_eq!(cases.len(), 18);
    let plan = cases.plan(0).unwrap();
    let layout = Layout::new(&cases, &plan).unwrap();
    let results: Vec<Vec<u8>> = [1, 2, 7]
        .into_iter()
        .map(|jobs| {
            let out = tempfile::tempdir().unwrap();
            let mut folder = Folder::open(out.path(), Disk::default(), "a test").unwrap();
            folder.begin(Targets { figures: &[], checkpoints: false, is_input: &|_| false }).unwrap();
            let (stop, progress) = (AtomicBool::new(false), Progress::default());
            let outcome = sweep::run(
                &cases,
                &layout,
                &mut folder,
                Options { jobs, stop: &stop, progress: &progress, checkpoints: None, source: None, shard: None },
            )
            .unwrap();
            assert_eq!(outcome.done, 18);
            std::fs::read(out.path().join("results.csv.part")).unwrap()
        })
        .collect();
    assert!(results[0].len() > 10_000);
    assert!(results.iter().all(|bytes| *bytes == results[0]));
}
