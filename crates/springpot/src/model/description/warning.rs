//! What was left out of a URDF file or assumed.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use super::problem::Owner;

/// Something that was not used, or assumed, at one or more places of the file.
///
/// `Display` is one line: what it is and the first places; [`DescriptionWarning::places`] has all of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DescriptionWarning {
    /// What it is.
    pub kind: DescriptionWarningKind,
    /// Where, in the order of the file; at least one.
    pub places: Vec<DescriptionPlace>,
}

/// Where a warning applies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DescriptionPlace {
    /// The link or joint.
    pub owner: Owner,
    /// Line of the file, from 1.
    pub line: usize,
    /// The element, the file as it is named, or the value; empty where the kind says it all.
    pub what: String,
}

/// The kinds of warning; what concerns the motion comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum DescriptionWarningKind {
    /// A link on a moving joint has no `<inertial>`; it is taken as massless.
    NoInertial,
    /// A link on a moving joint has the mass 0.
    ZeroMass,
    /// A link has an `<inertia>` that is not positive, but only of rounding errors: its entries are below 1e-15 m²
    /// times its mass. It is taken as 0, that of a point mass.
    PointMass,
    /// The largest principal moment of a link that moves is above the sum of the others by more than 1e-9 of itself.
    /// The tensor is used as it is.
    TriangleInequality,
    /// A link on a fixed joint, or the root on a fixed base, has a principal moment below −1e-12 of its largest; with
    /// [`DescriptionOptions::accept_inertia`](super::DescriptionOptions::accept_inertia) a link on any joint. What is fixed to the world has
    /// no part in the dynamics; of what moves, [`RobotDescription::model`](super::RobotDescription::model) decides.
    NotPositive,
    /// A moving joint has no `<axis>`; 1 0 0 is assumed, as the format says.
    NoAxis,
    /// The `<axis>` of a moving joint is not of length 1, by more than 1e-3; its direction is used.
    AxisLength,
    /// A revolute or prismatic joint has no `<limit>`; it is taken as unlimited.
    NoLimit,
    /// A `<limit>` is incomplete: lower and upper are then 0, as the format says, effort and velocity unlimited.
    IncompleteLimit,
    /// A lower limit above the upper one, or a largest effort or velocity that is not above 0: taken as unlimited.
    SenselessLimit,
    /// A limit of a revolute joint of more than three turns, which is one in degrees by the look of it; it is used as it is, in radians.
    LimitInDegrees,
    /// A `<mimic>` that was not applied because the caller asked so; the joint has its own coordinate.
    MimicIgnored,
    /// A fixed joint has the name of the joint that lets the base float; it gets another one.
    Renamed,
    /// An `<axis>`, `<dynamics>`, `<limit>` or `<mimic>` of a floating joint, which has no use for it.
    OfFloatingJoint,
    /// Something that changes the motion in a simulator: inside `<gazebo>`, or of MJCF.
    InSimulator,
    /// The robot has no name.
    NoName,
    /// Elements that are not known.
    UnknownElement,
    /// Attributes that are not known.
    UnknownAttribute,
    /// Text between elements.
    StrayText,
    /// Files of shapes that are not found. The dynamics need none.
    MeshNotFound,
    /// Files of shapes outside the folder of the robot and its packages, which are not read.
    MeshOutside,
    /// What is known and has no part in the dynamics.
    NotUsed,
}

/// How the places of a kind are shown.
enum Style {
    /// `link "a" (line 3), link "b" (line 9: what) and 4 more`
    Owners,
    /// `"file" of link "a" (line 3) and 12 more`
    Files,
    /// `<axis> of joint "a" (line 3), 3 <axis> (from line 9)`
    Elements,
    /// `3 <transmission>, 12 <gazebo>`
    Numbers,
}

impl DescriptionWarningKind {
    /// Every kind.
    pub const ALL: [Self; 22] = [
        Self::NoInertial,
        Self::ZeroMass,
        Self::PointMass,
        Self::TriangleInequality,
        Self::NotPositive,
        Self::NoAxis,
        Self::AxisLength,
        Self::NoLimit,
        Self::IncompleteLimit,
        Self::SenselessLimit,
        Self::LimitInDegrees,
        Self::MimicIgnored,
        Self::Renamed,
        Self::OfFloatingJoint,
        Self::InSimulator,
        Self::NoName,
        Self::UnknownElement,
        Self::UnknownAttribute,
        Self::StrayText,
        Self::MeshNotFound,
        Self::MeshOutside,
        Self::NotUsed,
    ];

    /// Its name, by which scenarios accept it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoInertial => "no-inertial",
            Self::ZeroMass => "zero-mass",
            Self::PointMass => "point-mass",
            Self::TriangleInequality => "triangle-inequality",
            Self::NotPositive => "not-positive",
            Self::NoAxis => "no-axis",
            Self::AxisLength => "axis-length",
            Self::NoLimit => "no-limit",
            Self::IncompleteLimit => "incomplete-limit",
            Self::SenselessLimit => "senseless-limit",
            Self::LimitInDegrees => "limit-in-degrees",
            Self::MimicIgnored => "mimic-ignored",
            Self::Renamed => "renamed",
            Self::OfFloatingJoint => "of-floating-joint",
            Self::InSimulator => "in-simulator",
            Self::NoName => "no-name",
            Self::UnknownElement => "unknown-element",
            Self::UnknownAttribute => "unknown-attribute",
            Self::StrayText => "stray-text",
            Self::MeshNotFound => "mesh-not-found",
            Self::MeshOutside => "mesh-outside",
            Self::NotUsed => "not-used",
        }
    }

    /// What it says before the places, and how they are shown.
    fn words(self) -> (&'static str, Style) {
        match self {
            Self::NoInertial => ("moving links without <inertial>, taken as massless", Style::Owners),
            Self::ZeroMass => ("moving links of mass 0", Style::Owners),
            Self::PointMass => ("<inertia> of rounding errors, taken as 0", Style::Owners),
            Self::TriangleInequality => ("<inertia> that no distribution of mass has", Style::Owners),
            Self::NotPositive => ("<inertia> with a negative principal moment", Style::Owners),
            Self::NoAxis => ("no <axis>, 1 0 0 assumed", Style::Owners),
            Self::AxisLength => ("<axis> not of length 1, its direction is used", Style::Owners),
            Self::NoLimit => ("no <limit>, taken as unlimited", Style::Owners),
            Self::IncompleteLimit => ("incomplete <limit>", Style::Owners),
            Self::SenselessLimit => ("senseless <limit>, taken as unlimited", Style::Owners),
            Self::LimitInDegrees => ("<limit> of more than three turns: degrees? radians are used", Style::Owners),
            Self::MimicIgnored => ("<mimic> not applied, own coordinates instead", Style::Owners),
            Self::Renamed => ("names that are reserved", Style::Owners),
            Self::OfFloatingJoint => ("not used, the joint is floating", Style::Elements),
            Self::InSimulator => ("not used, though it changes the motion in the simulator", Style::Elements),
            Self::NoName => ("no name", Style::Owners),
            Self::UnknownElement | Self::UnknownAttribute => ("not known, not used", Style::Elements),
            Self::StrayText => ("text between elements, not used", Style::Elements),
            Self::MeshNotFound => ("mesh files not found, not needed for the dynamics", Style::Files),
            Self::MeshOutside => {
                ("mesh files outside the folder of the robot and its packages (package_path), not read", Style::Files)
            }
            Self::NotUsed => ("not used", Style::Numbers),
        }
    }
}

impl DescriptionWarning {
    /// Line of the first place, from 1.
    pub fn line(&self) -> usize {
        self.places[0].line
    }

    /// How often each `what` stands here, and its first place, in the order of the file.
    fn groups(&self) -> Vec<(usize, &DescriptionPlace)> {
        let mut index = HashMap::new();
        let mut groups: Vec<(usize, &DescriptionPlace)> = Vec::new();
        for place in &self.places {
            let at = *index.entry(place.what.as_str()).or_insert(groups.len());
            match groups.get_mut(at) {
                Some((count, _)) => *count += 1,
                None => groups.push((1, place)),
            }
        }
        groups
    }
}

impl fmt::Display for DescriptionWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (lead, style) = self.kind.words();
        write!(f, "{lead}: ")?;
        let owner_and_line = |DescriptionPlace { owner, line, what }: &DescriptionPlace| match what.as_str() {
            "" => format!("{owner} (line {line})"),
            what => format!("{owner} (line {line}: {what})"),
        };
        let of_owner = |DescriptionPlace { owner, line, what }: &DescriptionPlace| match owner {
            Owner::Robot | Owner::Mujoco => format!("{what} (line {line})"),
            owner => format!("{what} of {owner} (line {line})"),
        };
        match style {
            Style::Owners => listed(f, 4, self.places.iter().map(owner_and_line)),
            Style::Files => listed(
                f,
                2,
                self.places
                    .iter()
                    .map(|DescriptionPlace { owner, line, what }| format!("{what:?} of {owner} (line {line})")),
            ),
            Style::Elements => {
                let groups = self.groups().into_iter().map(|(count, first)| match count {
                    1 => of_owner(first),
                    count => format!("{count} {} (from line {})", first.what, first.line),
                });
                listed(f, 8, groups)
            }
            Style::Numbers => listed(
                f,
                16,
                self.groups().into_iter().map(|(count, DescriptionPlace { what, .. })| format!("{count} {what}")),
            ),
        }
    }
}

/// `a, b, c and 5 more`, of which `shown` are shown.
fn listed(f: &mut fmt::Formatter<'_>, shown: usize, items: impl ExactSizeIterator<Item = String>) -> fmt::Result {
    let more = items.len().saturating_sub(shown);
    for (k, item) in items.take(shown).enumerate() {
        write!(f, "{}{item}", if k > 0 { ", " } else { "" })?;
    }
    if more > 0 { write!(f, " and {more} more") } else { Ok(()) }
}

/// Warnings while they are gathered.
#[derive(Debug, Default)]
pub(super) struct Warnings(BTreeMap<DescriptionWarningKind, Vec<DescriptionPlace>>);

impl Warnings {
    pub(super) fn add(&mut self, kind: DescriptionWarningKind, owner: &Owner, line: usize, what: impl Into<String>) {
        self.0.entry(kind).or_default().push(DescriptionPlace { owner: owner.clone(), line, what: what.into() });
    }

    /// By kind; within one in the order of the file.
    pub(super) fn finish(self) -> Vec<DescriptionWarning> {
        let in_order = |(kind, mut places): (_, Vec<DescriptionPlace>)| {
            places.sort_by_key(|place| place.line);
            DescriptionWarning { kind, places }
        };
        self.0.into_iter().map(in_order).collect()
    }
}
