//! A starter for a robot from a file: its joints, and an element between two of its links.

use crate::arguments::InitOptions;
use crate::{Ending, diagnostic};
use springpot::law::Catalog;
use springpot::model::description::{DescriptionOptions, DescriptionProblem, RobotDescription};
use springpot::model::{BodySpec, DescribedJoint, Dimension, Limits, Model, Parent, Space};
use springpot_scenario::{Scenario, suggest, toml_key};
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Pairs of links that are looked at.
const MOST_PAIRS: usize = 60;
/// An element is good enough when it is as long as this, m, and its length changes as fast with a joint, m/rad or 1.
const LENGTH: f64 = 0.03;
const CHANGE: f64 = 0.02;
/// Where the point of the first link may be, beside its centre of mass, m.
const OFFSETS: [[f64; 3]; 4] = [[0.0; 3], [0.0, 0.0, 0.05], [0.0, 0.05, 0.0], [0.05, 0.0, 0.0]];
/// How far joints swing, rad and m.
const SWING: f64 = 0.2;
const SLIDE: f64 = 0.02;

/// The starter for `robot`, to be written to `out`; what is wrong with the robot goes to stderr.
pub(super) fn scenario(robot: &Path, out: &Path, options: &InitOptions, catalog: &Catalog) -> Result<String, Ending> {
    let floats = options.floating_base;
    let accept_inertia = options.accept_inertia;
    let how = DescriptionOptions { floating_base: floats, accept_inertia, ..DescriptionOptions::default() };
    let read = RobotDescription::read(robot, &how).and_then(|urdf| {
        let model = urdf.model(urdf.gravity.unwrap_or(GRAVITY))?;
        Ok((urdf, model))
    });
    let (urdf, model) = read.map_err(|error| {
        match *error.problem {
            DescriptionProblem::NothingMoves { .. } => {
                let help = format!("with `springpot init {} --floating-base` it floats", robot.display());
                diagnostic::error_with_help(error.to_string(), help);
            }
            _ => diagnostic::description_refused(&error),
        }
        Ending::Refused
    })?;
    if model.joint_count() == 0 {
        let message = format!("{}: no joint moves: all are fixed", robot.display());
        let help = format!("with `springpot init {} --floating-base` its root link floats", robot.display());
        diagnostic::error_with_help(message, help);
        return Err(Ending::Refused);
    }
    let path = relative(robot, out);
    let forward = options.forward;
    let asked = [&options.from, &options.to, &options.gripper];
    let names_root = !floats && asked.into_iter().flatten().any(|name| *name == urdf.root.name);
    let mut starter = Starter {
        urdf: &urdf,
        model: &model,
        catalog,
        path,
        folder: folder(out),
        floats,
        forward,
        gripper: None,
        names_root,
    };
    starter.gripper = options.gripper.as_deref().map(|name| starter.link(name)).transpose()?;
    let [from, to] =
        [&options.from, &options.to].map(|name| name.as_deref().map(|name| starter.link(name)).transpose());
    let pairs = starter.pairs_of(from?, to?)?;
    Ok(starter.text(&starter.best_strut(pairs)))
}

/// Two points, and the joints between them.
struct Strut {
    from: (Parent, [f64; 3]),
    to: (Parent, [f64; 3]),
    /// Joints whose coordinates change its length.
    joints: Vec<usize>,
}

/// Two links, and the joints between them.
type Pair = (Parent, Parent, Vec<usize>);

struct Starter<'a> {
    urdf: &'a RobotDescription,
    model: &'a Model,
    catalog: &'a Catalog,
    /// The robot's file as the scenario names it.
    path: String,
    folder: PathBuf,
    /// Whether the root link floats.
    floats: bool,
    /// Whether it moves by forces.
    forward: bool,
    /// The link of the gripper.
    gripper: Option<Parent>,
    /// Whether the world is called as the root link is: where it was asked for by that name.
    names_root: bool,
}

impl Starter<'_> {
    /// The link of that name.
    fn link(&self, name: &str) -> Result<Parent, Ending> {
        let known = self.bodies().iter().map(|body| body.name.as_str());
        if let Some(index) = known.clone().position(|own| own == name) {
            return Ok(Parent::Body(index));
        }
        // The root link of a robot that does not float is the world.
        if name == "world" || !self.floats && name == self.urdf.root.name {
            return Ok(Parent::World);
        }
        let root = (!self.floats).then_some(self.urdf.root.name.as_str());
        let help = suggest(name, root.into_iter().chain(known).collect::<Vec<_>>());
        diagnostic::error_with_help(format!("the robot has no link {name:?}"), help);
        Err(Ending::Refused)
    }

    /// The first of the `pairs` whose distance changes well.
    fn best_strut(&self, pairs: Vec<Pair>) -> Strut {
        let mut best: Option<(f64, Strut)> = None;
        for (from, to, joints) in pairs.into_iter().take(MOST_PAIRS) {
            for offset in OFFSETS {
                let at = |k: usize| round(self.com(from)[k] + offset[k]);
                let strut = Strut {
                    from: (from, [0, 1, 2].map(at)),
                    to: (to, self.com(to).map(round)),
                    joints: joints.clone(),
                };
                let Some((length, change)) = self.measured(&strut) else { continue };
                if length >= LENGTH && change >= CHANGE {
                    return strut;
                }
                let score = (length / LENGTH).min(change / CHANGE);
                if best.as_ref().is_none_or(|(most, _)| score > *most) {
                    best = Some((score, strut));
                }
            }
        }
        let any = || Strut {
            from: (Parent::World, OFFSETS[1]),
            to: (Parent::Body(self.model.joint_body(0)), [0.05, 0.0, 0.0]),
            joints: vec![0],
        };
        best.map_or_else(any, |(_, strut)| strut)
    }

    /// Links to begin at, with the joints from there to the other end: two joints apart first, moving links before the
    /// world.
    fn pairs(&self) -> Vec<Pair> {
        let described = self.model.described_joints();
        // The joint that carries another one, both as they are described.
        let parent = |joint: &DescribedJoint| {
            let carrier = self.model.parent_link(joint.joints.start).checked_sub(1)?;
            described.iter().find(|other| other.joints.contains(&carrier))
        };
        let body = |joint: Option<&DescribedJoint>| {
            joint.map_or(Parent::World, |joint| Parent::Body(self.model.joint_body(joint.joints.start)))
        };
        let both =
            |one: &DescribedJoint, other: &DescribedJoint| one.joints.clone().chain(other.joints.clone()).collect();
        let two = described.iter().filter_map(|j| parent(j).map(|above| (body(parent(above)), both(above, j))));
        let one = described.iter().map(|j| (body(parent(j)), j.joints.clone().collect()));
        let (moving, fixed): (Vec<(Parent, Vec<usize>)>, Vec<_>) = two.partition(|(from, _)| *from != Parent::World);
        let to = |joints: &[usize]| Parent::Body(self.model.joint_body(joints[joints.len() - 1]));
        let pairs = moving.into_iter().chain(fixed).chain(one).map(|(from, joints)| (from, to(&joints), joints));
        if !self.urdf.is_mjcf() {
            return pairs.collect();
        }
        // Links between the joints of one body are nobody's.
        let pairs = pairs.map(|(from, to, _)| [from, to].map(|end| self.whole(end)));
        let pairs = pairs.map(|[from, to]| (from, to, self.between(from, to)));
        pairs.filter(|(.., joints)| !joints.is_empty()).collect()
    }

    /// The body that a link is, or is one of the links of.
    fn whole(&self, link: Parent) -> Parent {
        let Some((body, _)) = self.name(link).split_once('/') else { return link };
        self.bodies().iter().position(|other| other.name == body).map_or(link, Parent::Body)
    }

    /// The pairs of which the ends that are given are part; without any, [`Self::pairs`].
    fn pairs_of(&self, from: Option<Parent>, to: Option<Parent>) -> Result<Vec<Pair>, Ending> {
        if from.is_none() && to.is_none() {
            return Ok(self.pairs());
        }
        let all = || std::iter::once(Parent::World).chain((0..self.bodies().len()).map(Parent::Body));
        let ends = |given: Option<Parent>| -> Vec<Parent> { given.map_or_else(|| all().collect(), |end| vec![end]) };
        let (from_ends, to_ends) = (ends(from), ends(to));
        let pairs = from_ends.iter().flat_map(|from| to_ends.iter().map(|to| (*from, *to, self.between(*from, *to))));
        let mut pairs: Vec<Pair> = pairs.filter(|(.., joints)| !joints.is_empty()).collect();
        pairs.sort_by_key(|(.., joints)| joints.len().abs_diff(2));
        if let (true, Some(from), Some(to)) = (pairs.is_empty(), from, to) {
            let message = match from == to {
                true => format!("--from and --to are one link, {:?}: an element joins two", self.name(from)),
                false => format!("no joint moves between {:?} and {:?}", self.name(from), self.name(to)),
            };
            let help = "name links with a moving joint between them; `springpot info` shows links and joints";
            diagnostic::error_with_help(message, help.to_owned());
            return Err(Ending::Refused);
        }
        if pairs.is_empty() {
            let names = [from, to].into_iter().flatten().map(|end| format!("{:?}", self.name(end))).collect::<Vec<_>>();
            let message = format!("no joint moves between {} and another link", names.join(" and "));
            diagnostic::error_with_help(message, "`springpot info` shows links and joints".to_owned());
            return Err(Ending::Refused);
        }
        Ok(pairs)
    }

    /// The joints that move one link against another.
    fn between(&self, one: Parent, other: Parent) -> Vec<usize> {
        let (mut joints, others) = (self.above(one), self.above(other));
        let shared: Vec<usize> = joints.iter().copied().filter(|joint| others.contains(joint)).collect();
        joints.extend(others);
        joints.retain(|joint| !shared.contains(joint));
        joints
    }

    /// The moving joints between a link and the world.
    fn above(&self, mut link: Parent) -> Vec<usize> {
        let mut joints = Vec::new();
        while let Parent::Body(index) = link {
            let body = &self.bodies()[index];
            let described = self.model.described_joints().iter().find(|joint| joint.name == body.joint.name);
            joints.extend(described.into_iter().flat_map(|joint| joint.joints.clone()));
            link = body.parent;
        }
        joints
    }

    /// l(0) and the largest |∂l/∂q|; `None` where the scenario is not admissible.
    fn measured(&self, strut: &Strut) -> Option<(f64, f64)> {
        let text = self.text(strut);
        let cases = Scenario::parse(&text, "", &self.folder).ok()?.cases(self.catalog).ok()?;
        let starts = cases.plan(0).ok()?.system().element_starts().ok()?;
        let start = starts.first()?;
        Some((start.length, start.gradient.iter().map(|g| g.abs()).fold(0.0, f64::max)))
    }

    fn com(&self, link: Parent) -> [f64; 3] {
        match link {
            Parent::World => [0.0; 3],
            Parent::Body(index) => self.bodies()[index].com,
        }
    }

    fn bodies(&self) -> &[BodySpec] {
        &self.urdf.bodies
    }

    fn name(&self, link: Parent) -> &str {
        match link {
            Parent::World if self.names_root => &self.urdf.root.name,
            Parent::World => "world",
            Parent::Body(index) => &self.bodies()[index].name,
        }
    }

    fn text(&self, strut: &Strut) -> String {
        let name = if self.urdf.name.is_empty() { "The robot" } else { &self.urdf.name };
        let anchor = |(link, point): (Parent, [f64; 3])| {
            format!("{{ body = {}, point = [{}] }}", quoted(self.name(link)), point.map(|x| format!("{x}")).join(", "))
        };
        format!(
            "# A scenario: a robot, elements between its links, a motion, and what to draw.\n\
             # Plain numbers are in SI units, angles in radians; \"30 cm\" and \"25 degC\" carry their own.\n\
             # docs/SCENARIO.md describes every key; an editor completes them with the schema of `springpot check --schema`.\n\
             title = {title}\n\
             \n\
             # {about}`springpot info` shows links, joints and limits.\n\
             [robot]\n\
             {key} = {urdf}\n\
             {floating_base}{accept_inertia}\
             {gripper}\
             \n\
             # A material between two points, each in the frame of its link.\n\
             # `springpot laws` lists the laws, `springpot laws --from DATA` reads a data sheet.\n\
             [[element]]\n\
             name = \"strut\"\n\
             from = {from}\n\
             to = {to}\n\
             rest_length = \"start\"   # its length at t = 0; the stroke is length less rest length\n\
             law = \"fractional-kelvin-voigt\"   # F = k·x + c·D^alpha x\n\
             parameters = {{ k = \"2 N/cm\", c = \"50 N*s^alpha/m\", alpha = 0.4 }}\n\
             \n\
             {motion}\
             \n\
             [time]\n\
             end = \"2 s\"\n\
             output_step = \"10 ms\"\n\
             \n\
             # Every combination of the values of all [[sweep]] blocks is a case.\n\
             [[sweep]]\n\
             parameter = \"element.strut.alpha\"\n\
             values = [0.2, 0.4, 0.8]\n\
             \n\
             # Columns over columns; the first sweep makes the curves.\n\
             [[figure]]\n\
             name = \"force\"\n\
             title = \"Force of the strut\"\n\
             y = \"strut.force\"\n\
             \n\
             [[figure]]\n\
             name = \"robot\"\n\
             kind = \"robot\"\n",
            title = quoted(&format!("{name} with a strut")),
            about = match self.urdf.is_mjcf() {
                true => "Points are in the frames of the file's bodies. ",
                false => "The root link is the world; with floating_base = true it floats. ",
            },
            key = if self.urdf.is_mjcf() { "mjcf" } else { "urdf" },
            urdf = quoted(&self.path),
            from = anchor(strut.from),
            to = anchor(strut.to),
            floating_base = if self.floats { "floating_base = true\n" } else { "" },
            accept_inertia = if self.urdf.accept_inertia { "accept_inertia = true\n" } else { "" },
            gripper = self.gripper.map_or_else(String::new, |link| {
                let body = quoted(self.name(link));
                format!("\n# A point whose coordinates are columns, and which a gripper path moves.\n[robot.gripper]\nbody = {body}\npoint = [0, 0, 0]\n")
            }),
            motion = match self.forward {
                true => format!(
                    "# The robot moves by itself from here, at rest: by gravity, the strut and what [motion.torque] says.\n\
                     # With kind = \"prescribed\" every joint follows a function of t.\n\
                     [motion]\n\
                     kind = \"forward\"\n\
                     \n\
                     [motion.start.q]\n\
                     {}",
                    self.joints(&[])
                ),
                false => format!(
                    "# Every joint follows a function of t; here those move that the strut crosses.\n\
                     # With kind = \"forward\" the robot moves by itself.\n\
                     [motion]\n\
                     kind = \"prescribed\"\n\
                     \n\
                     [motion.joints]\n\
                     {}",
                    self.joints(&strut.joints)
                ),
            },
        )
    }

    /// A line for every joint that has a coordinate of its own.
    fn joints(&self, moving: &[usize]) -> String {
        let names = self.model.joint_names();
        // A joint that follows another one moves with it.
        let moving: Vec<usize> =
            moving.iter().map(|&j| self.model.followed(j).map_or(j, |(leader, ..)| leader)).collect();
        let mut text = String::new();
        let placed = |j: usize| {
            let name = &self.model.described_joint(j).name;
            self.urdf.start.iter().find(|(joint, _)| joint == name).map(|(_, at)| &at[..])
        };
        let signal = |j: usize| match (self.model.joint_space(j), moving.contains(&j)) {
            (_, false) if placed(j).is_some() => place(placed(j).unwrap_or_default()),
            (Space::Line(dimension), moves) => signal(dimension, self.model.limits(j), moves),
            (Space::Circle, moves) => signal(Dimension::Angle, self.model.limits(j), moves),
            (Space::Pose, true) => format!("{{ z = \"{SLIDE}*sin(2*pi*t)\" }}"),
            (Space::Attitude, true) => format!("{{ rpy = [\"{SWING}*sin(2*pi*t)\", 0, 0] }}"),
            (Space::Attitude | Space::Pose, false) => "{}".to_owned(),
        };
        for joint in self.model.described_joints() {
            let said = match joint.joints.clone() {
                only if only.len() == 1 && self.model.followed(only.start).is_some() => continue,
                only if only.len() == 1 => signal(only.start),
                several => {
                    let part = |j: usize| format!("{} = {}", &names[j][joint.name.len() + 1..], signal(j));
                    format!("{{ {} }}", several.map(part).collect::<Vec<_>>().join(", "))
                }
            };
            let _ = writeln!(text, "{} = {said}", toml_key(&joint.name));
        }
        text
    }
}

/// A coordinate, or a place in the world and an attitude, to 1e-9.
fn place(at: &[f64]) -> String {
    let near = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
    let &[x, y, z, roll, pitch, yaw] = at else { return format!("{}", at.first().map_or(0.0, |at| near(*at))) };
    let place = format!("x = {}, y = {}, z = {}", near(x), near(y), near(z));
    match [roll, pitch, yaw].map(near) {
        [0.0, 0.0, 0.0] => format!("{{ {place} }}"),
        rpy => format!("{{ {place}, rpy = {rpy:?} }}"),
    }
}

/// A swing within the limits, or rest, about 0 or, where the limits leave that out, about their middle.
fn signal(dimension: Dimension, limits: &Limits, moves: bool) -> String {
    let most = if dimension == Dimension::Length { SLIDE } else { SWING };
    let finite = limits.lower.is_finite() && limits.upper.is_finite() && limits.lower < limits.upper;
    let middle = match finite {
        true if limits.lower + most > 0.0 || limits.upper - most < 0.0 => round(0.5 * (limits.lower + limits.upper)),
        _ => 0.0,
    };
    let room = if finite { 0.4 * (limits.upper - limits.lower) } else { f64::INFINITY };
    // At 1 Hz the speed is 2π times the swing.
    let speed = if limits.velocity > 0.0 { 0.9 * limits.velocity / std::f64::consts::TAU } else { f64::INFINITY };
    let swing = round(most.min(room).min(speed));
    match (moves && swing > 0.0, middle) {
        (false, middle) => format!("{middle}"),
        (true, 0.0) => format!("\"{swing}*sin(2*pi*t)\""),
        (true, middle) => format!("\"{middle} + {swing}*sin(2*pi*t)\""),
    }
}

/// To the millimetre, or the milliradian.
fn round(value: f64) -> f64 {
    // Adding 0 makes −0 a 0.
    (value * 1000.0).round() / 1000.0 + 0.0
}

/// A text of TOML, whose escapes are those of JSON but for DEL.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007F")
}

fn folder(out: &Path) -> PathBuf {
    out.parent().unwrap_or(Path::new("")).to_owned()
}

/// The path of the robot's file from the folder of `out`.
fn relative(robot: &Path, out: &Path) -> String {
    let folder = folder(out);
    let typed = || robot.to_string_lossy().into_owned();
    if robot.is_absolute() || folder.as_os_str().is_empty() {
        return typed();
    }
    let (Ok(robot), Ok(folder)) = (robot.canonicalize(), folder.canonicalize()) else { return typed() };
    let (robot_parts, folder_parts): (Vec<_>, Vec<_>) = (robot.components().collect(), folder.components().collect());
    let common = robot_parts.iter().zip(&folder_parts).take_while(|(a, b)| a == b).count();
    let up = folder_parts[common..].iter().map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(robot_parts[common..].iter().copied()).collect();
    path.to_string_lossy().into_owned()
}
