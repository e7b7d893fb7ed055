//! Rows and threads change nothing.

use springpot::law::Catalog;
use springpot_run::sweep::{self, Layout, Options, Parcel, Progress};
use springpot_run::table::disk::Disk;
use springpot_run::table::folder::{Folder, Targets};
use springpot_run::{Depth, Survey};
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

/// Cases that move alike: one look at their signals, whoever asks, and a kernel for each order.
#[test]
fn signals_are_looked_through_once_for_each_motion() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let text = std::fs::read_to_string(format!("{folder}/thermoviscoelastic_order.toml")).unwrap();
    let looked = |sweep: Option<&str>| {
        let mut scenario = Scenario::parse(&text, "arm.toml", folder).unwrap();
        scenario.set("time.end=0.1").unwrap();
        sweep.into_iter().for_each(|sweep| scenario.sweep(sweep).unwrap());
        let cases = scenario.cases(&Catalog::standard()).unwrap();
        let (stop, progress) = (AtomicBool::new(false), Progress::default());
        let plan = cases.plan(0).unwrap();
        let (layout, system) = (Layout::new(&cases, &plan).unwrap(), plan.system().sharing(cases.shared()));
        Survey::of(&cases, &plan, &system, Depth::Paths, &stop).unwrap();
        system.switches(&plan.settings, &stop).unwrap();
        assert!(cases.shared().kernels().is_empty(), "a survey needs none");
        for index in 0..cases.len() {
            let parcel = Parcel::run(&cases, &layout, index, &stop, &progress).unwrap();
            assert!(parcel.error().is_none());
        }
        (cases.shared().looked(), cases.shared().kernels().len())
    };
    // Of six orders one is 1, which has no kernel.
    assert_eq!(looked(None), (1, 5));
    assert_eq!(looked(Some("motion.joints.q3=0.1*t,0.2*sin(t)")).0, 2);
}
