//! Recordings of a run as ROS 2 makes them: MCAP files that Foxglove, Lichtblick and `ros2 bag` read.
//!
//! Every row is written with all its columns and all its digits. Times are ns from 0; `t` itself is a field of `/columns`.
//!
//! | topic | messages |
//! |---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` of all joints of one coordinate, those that follow others too |
//! | `/tf` | `tf2_msgs/msg/TFMessage`: every body in the frame of its parent, one tree from `world` on |
//! | `/gripper` | `geometry_msgs/msg/PointStamped` in `world` |
//! | `/elements/NAME` | a number for each column of an element |
//! | `/columns` | a number for each column that is nowhere else |
//! | `/events` | names of what happened |
//!
//! The metadata `springpot` tells what was run; `springpot.columns` the topic and the field of every column. Chunks and sections have CRCs. Nothing is
//! compressed: the compressions of the format, LZ4 and Zstandard, are libraries in C, and a build of Springpot needs no compiler of C.

mod cdr;
mod definition;
mod layout;
mod names;
mod sink;

use crate::page::ViewColumn;
use crate::scene::{Kinematics, Placement, Scene};
use cdr::{Cdr, Stamp};
use definition::Schema;
use layout::Layout;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions};
use sink::Sink;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// The frame that all others hang on.
const WORLD: &str = "world";
const JOINTS: &str = "/joint_states";
const FRAMES: &str = "/tf";
const GRIPPER: &str = "/gripper";
const COLUMNS: &str = "/columns";
const EVENTS: &str = "/events";

/// What is recorded.
#[derive(Debug, Clone)]
pub struct About<'a> {
    /// The version of Springpot that ran it.
    pub version: &'a str,
    /// What the results are: title, case, swept values; by name.
    pub facts: BTreeMap<String, String>,
    /// The robot.
    pub scene: &'a Scene,
    /// Columns of the rows; one is called `t`.
    pub columns: &'a [ViewColumn],
    /// Names of the elements: columns begin with them.
    pub elements: &'a [String],
    /// Whether there are events to come.
    pub has_events: bool,
}

/// A recording that is being written.
pub struct Recording<W: Write> {
    writer: mcap::Writer<NoSeek<Sink<W>>>,
    failed: sink::Failure,
    layout: Layout,
    tree: Kinematics,
    time: Option<usize>,
    joints: Option<Channel>,
    frames: Option<Channel>,
    gripper: Option<Channel>,
    groups: Vec<Channel>,
    events: Option<Channel>,
    message: Cdr,
}

/// A channel, and how many messages it has.
#[derive(Debug)]
struct Channel {
    id: u16,
    count: u32,
}

impl<W: Write> Recording<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// What `out` says; more than 65 000 elements.
    pub fn begin(out: W, about: &About<'_>) -> io::Result<Self> {
        let column = |name: &str| about.columns.iter().position(|column| column.name == name);
        let tree = Kinematics::new(about.scene, column);
        let layout = Layout::new(about.scene, about.columns, about.elements, &tree);
        let (out, failed) = Sink::new(out);
        let options = WriteOptions::new().profile("ros2").library(format!("springpot {}", about.version));
        let writer = options.compression(None).disable_seeking(true).create(NoSeek::new(out)).map_err(plain)?;
        let mut new = Self {
            writer,
            failed,
            tree,
            time: column("t"),
            joints: None,
            frames: None,
            gripper: None,
            groups: Vec::with_capacity(layout.groups.len()),
            events: None,
            layout,
            message: Cdr::new(),
        };
        new.metadata("springpot", about.facts.clone())?;
        new.metadata("springpot.columns", new.layout.places.clone())?;
        if !new.layout.joints.is_empty() {
            new.joints = Some(new.channel(JOINTS, &definition::joint_state())?);
        }
        if !new.layout.frames.is_empty() {
            new.frames = Some(new.channel(FRAMES, &definition::transforms())?);
        }
        if new.layout.gripper.is_some() {
            new.gripper = Some(new.channel(GRIPPER, &definition::point())?);
        }
        for group in 0..new.layout.groups.len() {
            let (topic, schema) = (new.layout.groups[group].topic.clone(), new.layout.groups[group].schema.clone());
            let channel = new.channel(&topic, &schema)?;
            new.groups.push(channel);
        }
        if about.has_events {
            new.events = Some(new.channel(EVENTS, &definition::event())?);
        }
        Ok(new)
    }

    /// Writes a row.
    ///
    /// # Errors
    /// What `out` says.
    pub fn row(&mut self, row: &[f64]) -> io::Result<()> {
        let stamp = Stamp::new(self.time.map_or(0.0, |time| row[time]));
        let Self { writer, layout, message, .. } = self;
        if let Some(channel) = &mut self.joints {
            joint_states(message, stamp, layout, &self.tree, row);
            send(writer, channel, stamp, message)?;
        }
        if let Some(channel) = &mut self.frames {
            transforms(message, stamp, layout, &self.tree, row);
            send(writer, channel, stamp, message)?;
        }
        if let (Some(channel), Some(columns)) = (&mut self.gripper, layout.gripper) {
            message.begin().header(stamp, WORLD);
            columns.iter().for_each(|column| _ = message.f64(row[*column]));
            send(writer, channel, stamp, message)?;
        }
        for (group, channel) in layout.groups.iter().zip(&mut self.groups) {
            message.begin().header(stamp, "");
            group.columns.iter().for_each(|column| _ = message.f64(row[*column]));
            send(writer, channel, stamp, message)?;
        }
        self.failed.check()
    }

    /// Writes what happened at a time, s.
    ///
    /// # Errors
    /// What `out` says.
    pub fn event(&mut self, t: f64, name: &str) -> io::Result<()> {
        let stamp = Stamp::new(t);
        if let Some(channel) = &mut self.events {
            self.message.begin().header(stamp, "").string(name);
            send(&mut self.writer, channel, stamp, &self.message)?;
        }
        self.failed.check()
    }

    /// Writes the index of the file.
    ///
    /// # Errors
    /// What `out` says.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(plain)?;
        self.failed.check()
    }

    fn metadata(&mut self, name: &str, metadata: BTreeMap<String, String>) -> io::Result<()> {
        self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata }).map_err(plain)
    }

    fn channel(&mut self, topic: &str, schema: &Schema) -> io::Result<Channel> {
        let schema = self.writer.add_schema(&schema.name, "ros2msg", schema.text.as_bytes()).map_err(plain)?;
        let id = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(plain)?;
        Ok(Channel { id, count: 0 })
    }
}

fn joint_states(message: &mut Cdr, stamp: Stamp, layout: &Layout, tree: &Kinematics, row: &[f64]) {
    message.begin().header(stamp, "").length(layout.joints.len());
    for joint in &layout.joints {
        message.string(&joint.name);
    }
    let drives = || layout.joints.iter().map(|joint| (joint, tree.drive(joint.body)));
    message.numbers(drives().map(|(_, drive)| drive.map_or(f64::NAN, |drive| drive.value(row))));
    let speed = |(joint, drive): (&layout::JointRow, Option<crate::scene::Drive>)| match (joint.velocity, drive) {
        (Some(column), Some(drive)) => drive.ratio * row[column],
        _ => f64::NAN,
    };
    let shown = if layout.has_velocities() { layout.joints.len() } else { 0 };
    message.numbers(drives().take(shown).map(speed));
    let shown = if layout.has_efforts() { layout.joints.len() } else { 0 };
    message.numbers(layout.joints.iter().take(shown).map(|joint| joint.effort.map_or(f64::NAN, |column| row[column])));
}

fn transforms(message: &mut Cdr, stamp: Stamp, layout: &Layout, tree: &Kinematics, row: &[f64]) {
    let has_root = layout.base != WORLD;
    message.begin().length(layout.frames.len() + usize::from(has_root));
    let mut one = |parent: &str, child: &str, placement: &Placement| {
        message.header(stamp, parent).string(child);
        placement.shift.iter().chain(&placement.turn).for_each(|number| _ = message.f64(*number));
    };
    if has_root {
        one(WORLD, &layout.base, &Placement::IDENTITY);
    }
    for (body, placement) in tree.local(row).iter().enumerate() {
        let parent = tree.parent(body).map_or(&layout.base, |parent| &layout.frames[parent]);
        one(parent, &layout.frames[body], placement);
    }
}

fn send<W: Write>(
    writer: &mut mcap::Writer<NoSeek<Sink<W>>>,
    channel: &mut Channel,
    stamp: Stamp,
    message: &Cdr,
) -> io::Result<()> {
    let time = stamp.total();
    let header = MessageHeader { channel_id: channel.id, sequence: channel.count, log_time: time, publish_time: time };
    channel.count = channel.count.wrapping_add(1);
    writer.write_to_known_channel(&header, message.bytes()).map_err(plain)
}

fn plain(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes so many bytes.
    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn record(out: &mut dyn Write) -> io::Result<()> {
        let (scene, name) = (Scene::default(), |name: &str| name.to_owned());
        let column = |of: &str| ViewColumn { name: name(of), unit: name("s"), meaning: name("a\nb") };
        let columns = ["t", "pad.force", "pad.x.force"].map(column);
        let elements = [name("pad"), name("pad.x")];
        let about = About {
            version: "1",
            facts: BTreeMap::new(),
            scene: &scene,
            columns: &columns,
            elements: &elements,
            has_events: true,
        };
        let mut recording = Recording::begin(out, &about)?;
        for k in 0..3 {
            recording.row(&[f64::from(k), -0.0, f64::NAN])?;
            recording.event(f64::from(k), "x")?;
        }
        recording.finish()
    }

    #[test]
    fn a_full_disk_is_an_error_wherever_it_is_met() {
        let mut whole = Vec::new();
        record(&mut whole).unwrap();
        let topics: Vec<String> =
            mcap::MessageStream::new(&whole).unwrap().map(|message| message.unwrap().channel.topic.clone()).collect();
        assert_eq!(topics[..4], ["/elements/pad", "/elements/pad_x", "/columns", "/events"]);
        assert_eq!(topics.len(), 12);
        for size in 0..whole.len() {
            assert_eq!(record(&mut Full(size)).unwrap_err().kind(), io::ErrorKind::StorageFull, "{size}");
        }
        assert!(record(&mut Full(whole.len())).is_ok());
    }
}
