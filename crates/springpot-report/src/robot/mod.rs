//! A robot as a mechanism sketch: links, joints with their axes, elements, gripper.

mod element;
mod labels;
mod plane;
mod sketch;
mod symbols;
mod view;

use crate::{Drawn, Rendered, ReportError, draw, vector};

/// Name of the link that stands for the ground: its points are drawn with ground hatching.
pub const WORLD: &str = "world";

/// A robot in one pose, in world coordinates (metres, z upwards).
///
/// Without a view of its own the picture is seen from slightly above, turned so that links and elements hide one another least; a
/// robot that lies in a coordinate plane is seen straight on. All views are orthographic. The scale bar is true along lines parallel to the paper.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotDrawing {
    /// Stands above the picture.
    pub title: Option<String>,
    /// The bodies' centre lines. The first link of a name is drawn thick and named; later links of the same name are thin arms of
    /// the same body that carry anchors ([`RobotDrawing::bracket`]). Points of a link named [`WORLD`] are marked as fixed.
    pub links: Vec<Link>,
    /// The joints with their axes.
    pub joints: Vec<JointMark>,
    /// The elements between their two anchors.
    pub elements: Vec<ElementMark>,
    /// The gripper's point, labelled H.
    pub gripper: Option<[f64; 3]>,
    /// Where the robot stands; `None` for one that stands nowhere.
    pub ground: Option<[f64; 3]>,
    /// From where it is seen, degrees: the turn about z (at 0, x points to the right and y away), and the height above the horizon.
    pub view: Option<[f64; 2]>,
    /// Nothing is named; else what all names of bodies and joints begin with, up to a `_`, is left out.
    pub hides_names: bool,
    /// Width and height of the page, mm; else [`crate::WIDTH`] and what it takes. A picture that is larger is shrunk.
    pub size: Option<[f64; 2]>,
}

/// The centre line of a body, or a thin arm of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// The body's name.
    pub name: String,
    /// A polyline in world coordinates, metres.
    pub points: Vec<[f64; 3]>,
}

/// A joint and its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMark {
    /// The joint's name; a letter with a number, such as `q1`, is written q₁.
    pub name: String,
    /// Its origin in world coordinates, metres.
    pub position: [f64; 3],
    /// Its axis in world coordinates, of any length; the curved (straight) arrow shows the positive turn (slide). A zero axis draws none.
    pub axis: [f64; 3],
    /// What it lets its body do.
    pub kind: JointKind,
}

/// Kinds of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about the axis: a circle.
    Revolute,
    /// Slides along the axis: a rectangle.
    Prismatic,
    /// Turns about any axis: a circle within a circle.
    Spherical,
}

/// An element between two anchors, on a joint, or a bushing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementMark {
    /// The element's name.
    pub name: String,
    /// Anchor on the first body, world coordinates, metres.
    pub from: [f64; 3],
    /// Anchor on the second body.
    pub to: [f64; 3],
    /// What its law holds.
    pub sign: ElementSign,
    /// What it acts along.
    pub shape: ElementShape,
}

/// What an element acts along.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ElementShape {
    /// The straight line from anchor to anchor.
    #[default]
    Line,
    /// A cable over these points, world coordinates, metres: rollers.
    Cable(Vec<[f64; 3]>),
    /// The angle of a joint, where both anchors are: a spiral without the sign of the law.
    Turn,
    /// The shift of a joint, where both anchors are, along this axis (world coordinates, of any length): the sign of the law beside it.
    Slide([f64; 3]),
    /// The relative place of two frames at the anchors: a hatched ring without the sign of a law.
    Bushing,
}

impl ElementMark {
    /// The points it runs through.
    fn points(&self) -> Vec<[f64; 3]> {
        let via = if let ElementShape::Cable(via) = &self.shape { via } else { &Vec::new() };
        [self.from].into_iter().chain(via.iter().copied()).chain([self.to]).collect()
    }
}

/// What the law of an element holds.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ElementSign {
    /// A zigzag.
    #[default]
    Spring,
    /// A cup with a piston.
    Dashpot,
    /// A diamond.
    Springpot,
    /// A force that follows an input: a circle with an arrow.
    Source,
    /// Parts side by side: forces add.
    Parallel(Vec<ElementSign>),
    /// Parts one behind the other: strokes add.
    Series(Vec<ElementSign>),
}

impl RobotDrawing {
    /// Adds the thin arm that holds an anchor away from its body's centre line: from the nearest point of the link called `link` to
    /// `anchor`. For [`WORLD`], or a name no link has, the anchor is marked as fixed to the ground. An anchor on the line needs none.
    pub fn bracket(&mut self, link: &str, anchor: [f64; 3]) {
        let body = self.links.iter().find(|body| body.name == link && link != WORLD && !body.points.is_empty());
        let Some(foot) = body.map(|body| vector::nearest(&body.points, anchor)) else {
            self.links.push(Link { name: WORLD.into(), points: vec![anchor] });
            return;
        };
        if vector::distance(foot, anchor) > 0.0 {
            self.links.push(Link { name: link.into(), points: vec![foot, anchor] });
        }
    }

    /// Draws the robot.
    ///
    /// # Errors
    /// [`ReportError::NotFinite`] when a coordinate is NaN or infinite.
    pub fn render(&self) -> Result<Rendered, ReportError> {
        self.draw()?.rendered()
    }

    /// As [`Self::render`], where not all formats are wanted.
    ///
    /// # Errors
    /// As there.
    pub fn draw(&self) -> Result<Drawn, ReportError> {
        self.check()?;
        let font = draw::Font::load()?;
        Ok(Drawn::new(sketch::scene(self, &font), font))
    }

    fn check(&self) -> Result<(), ReportError> {
        let links = self.links.iter().flat_map(|link| link.points.iter().map(|p| (link.name.as_str(), p)));
        let joints = self.joints.iter().flat_map(|j| [(j.name.as_str(), &j.position), (j.name.as_str(), &j.axis)]);
        let ends = self.elements.iter().flat_map(|e| [(e.name.as_str(), &e.from), (e.name.as_str(), &e.to)]);
        let via = self.elements.iter().filter_map(|e| match &e.shape {
            ElementShape::Cable(via) => Some(via.iter().map(|point| (e.name.as_str(), point))),
            _ => None,
        });
        let elements = ends.chain(via.flatten());
        let others = self.gripper.iter().map(|p| ("gripper", p)).chain(self.ground.iter().map(|p| ("ground", p)));
        let mut all = links.chain(joints).chain(elements).chain(others);
        // Squares of larger numbers would overflow.
        match all.find(|(_, point)| !point.iter().all(|v| v.abs() < 1e100)) {
            Some((what, _)) => Err(ReportError::NotFinite { what: what.to_owned() }),
            None => Ok(()),
        }
    }
}
