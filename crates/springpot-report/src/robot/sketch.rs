//! The sketch: what is drawn where.

use super::element;
use super::labels::{Frame, Request};
use super::plane::direction;
use super::symbols::{ARM, BODY, ELEMENT, JOINT, RING, SLIDE, SPIRAL, Sheet};
use super::view::View;
use super::{ElementMark, ElementShape, ElementSign, JointKind, JointMark, RobotDrawing, WORLD};
use crate::draw::{Align, Color, Font, INK, Point, Scene, Stroke, Text, wrap_evenly};
use crate::vector::{Vector, along, cross, distance, dot, unit};
use crate::{PIXELS_PER_MM, WIDTH};
use std::collections::HashMap;

/// The robot fills this box, pixels; one of more than [`FEW_JOINTS`] gets a larger one, so that their names find room.
const BOX: [f64; 2] = [440.0, 340.0];
/// Room for names and arrows on a page of a given size.
const BESIDE: f64 = 110.0;
const FEW_JOINTS: f64 = 10.0;
const LARGEST: f64 = 3.0;
const NAME_SIZE: f64 = 13.0;
const LINK_SIZE: f64 = 11.5;
const TITLE_SIZE: f64 = 15.0;
const TITLE_LINE: f64 = 20.0;
const BORDER: f64 = 14.0;
/// Tones of successive bodies.
const TONES: [Color; 3] = [Color(0x7d, 0x9c, 0xbc), Color(0xb9, 0xcc, 0xdf), Color(0x5c, 0x7d, 0xa0)];
const LINK_NAME: Color = Color(0x3d, 0x5a, 0x78);
/// Reach of a joint's axis before and behind the joint, and place and radius of the arrow about it.
const AXIS_AHEAD: f64 = 34.0;
const AXIS_BEHIND: f64 = 16.0;
const SENSE_AT: f64 = 26.0;
const SENSE: f64 = 9.0;
/// Length of the arms of the x-y-z sign.
const TRIAD: f64 = 30.0;
const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Names without room that are told one by one.
const MOST_LISTED: usize = 8;
/// Longest scale bar.
const SCALE_BAR: f64 = 90.0;

/// A view with its scale.
struct Camera {
    view: View,
    /// Pixels per metre.
    scale: f64,
}

impl Camera {
    fn of(robot: &RobotDrawing) -> Self {
        let view = View::of(robot);
        let links = robot.links.iter().flat_map(|link| link.points.iter().copied());
        let elements = robot.elements.iter().flat_map(ElementMark::points);
        let joints = robot.joints.iter().map(|joint| joint.position);
        let points = links.chain(elements).chain(joints).chain(robot.gripper).chain(robot.ground);
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for point in points {
            let p = view.project(point);
            low = [low[0].min(p[0]), low[1].min(p[1])];
            high = [high[0].max(p[0]), high[1].max(p[1])];
        }
        let [width, height] =
            room(robot).map(|side| side * (robot.joints.len() as f64 / FEW_JOINTS).sqrt().clamp(1.0, LARGEST));
        let scale = (width / (high[0] - low[0])).min(height / (high[1] - low[1]));
        // A robot of one point, or none, has no size to fill the box with.
        Self { view, scale: if scale.is_finite() && scale > 0.0 { scale } else { height } }
    }

    fn at(&self, point: Vector) -> Point {
        let [x, y] = self.view.project(point);
        [x * self.scale, -y * self.scale]
    }

    fn all(&self, points: &[Vector]) -> Vec<Point> {
        points.iter().map(|point| self.at(*point)).collect()
    }

    fn depth(&self, points: &[Vector]) -> f64 {
        points.iter().map(|point| dot(*point, self.view.into)).sum::<f64>() / points.len().max(1) as f64
    }
}

/// What the robot fills, pixels, where it has few joints; names need some room beside it.
fn room(robot: &RobotDrawing) -> [f64; 2] {
    let Some(size) = robot.size else { return BOX };
    let [width, height] = size.map(|side| side * PIXELS_PER_MM);
    // On a small page the picture is laid out larger, and shrunk.
    [(width - BESIDE).max(0.8 * width), (height - BESIDE).max(0.8 * height)]
}

pub(super) fn scene(robot: &RobotDrawing, font: &Font) -> Scene {
    let camera = Camera::of(robot);
    let mut sheet = Sheet::default();
    bodies(robot, &camera, &mut sheet);
    ground(robot, &camera, &mut sheet);
    let tips: Vec<Point> = robot.joints.iter().map(|joint| draw_joint(joint, &camera, &mut sheet)).collect();
    for element in &robot.elements {
        let [from, to] = [element.from, element.to].map(|end| camera.at(end));
        match &element.shape {
            ElementShape::Turn => sheet.spiral(from),
            ElementShape::Slide(axis) => {
                sheet.slide(from, direction(from, camera.at(along(element.from, 1.0, *axis))).0, &element.sign);
            }
            ElementShape::Bushing => sheet.bushing(from, to),
            ElementShape::Line | ElementShape::Cable(_) => {
                sheet.pin(from);
                sheet.pin(to);
            }
        }
    }
    if let Some(point) = robot.gripper {
        sheet.gripper(camera.at(point), gripper_direction(robot, &camera, point));
    }
    let unnamed = if robot.hides_names { Vec::new() } else { names(robot, &camera, &tips, &mut sheet, font) };
    triad_and_scale(robot.size, &camera, &mut sheet, font);
    let mut scene = page(robot, sheet, font);
    if !unnamed.is_empty() {
        scene.remarks.push(format!("no room for the names {}", listed(&unnamed)));
    }
    scene
}

fn ground(robot: &RobotDrawing, camera: &Camera, sheet: &mut Sheet) {
    let height = robot.ground.map_or(0.0, |ground| ground[2]);
    let heights = robot.links.iter().flat_map(|link| &link.points).map(|point| point[2] - height);
    let hangs = robot.ground.is_some() && heights.sum::<f64>() < 0.0;
    let down = if hangs { -1.0 } else { 1.0 };
    if let Some(ground) = robot.ground {
        sheet.base(camera.at(ground), down);
    }
    for point in robot.links.iter().filter(|link| link.name == WORLD).flat_map(|link| &link.points) {
        sheet.fixed(camera.at(*point), down);
    }
}

/// Bodies, arms and elements, those behind first.
fn bodies(robot: &RobotDrawing, camera: &Camera, sheet: &mut Sheet) {
    enum Piece<'a> {
        Body(Vec<Point>, Color, f64),
        Element(&'a ElementMark),
    }
    let mut tones: HashMap<&str, Color> = HashMap::new();
    let mut pieces = Vec::new();
    for link in robot.links.iter().filter(|link| link.name != WORLD && !link.points.is_empty()) {
        let tone = TONES[tones.len() % TONES.len()];
        let width = if tones.contains_key(link.name.as_str()) { ARM } else { BODY };
        let tone = *tones.entry(&link.name).or_insert(tone);
        pieces.push((camera.depth(&link.points), Piece::Body(camera.all(&link.points), tone, width)));
    }
    for element in &robot.elements {
        if matches!(element.shape, ElementShape::Line | ElementShape::Cable(_)) {
            pieces.push((camera.depth(&element.points()), Piece::Element(element)));
        }
    }
    pieces.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, piece) in pieces {
        match piece {
            Piece::Body(points, tone, width) => sheet.body(&points, tone, width),
            Piece::Element(element) => {
                let points = camera.all(&element.points());
                let (at, [from, to]) = signed_piece(&points);
                sheet.cable(&points[..=at]);
                sheet.cable(&points[at + 1..]);
                sheet.element(from, to, &element.sign);
                points[1..points.len() - 1].iter().for_each(|point| sheet.roller(*point));
            }
        }
    }
}

/// Draws a joint with its axis; answers the place its name may stand beside first.
fn draw_joint(joint: &JointMark, camera: &Camera, sheet: &mut Sheet) -> Point {
    let at = camera.at(joint.position);
    let metre = 1.0 / camera.scale;
    let Some(axis) = unit(joint.axis) else {
        match joint.kind {
            JointKind::Revolute => sheet.revolute(at),
            JointKind::Prismatic => sheet.prismatic(at, [1.0, 0.0]),
            JointKind::Spherical => sheet.spherical(at),
        }
        return at;
    };
    let [x, y] = camera.view.project(axis);
    // Lengthened, so that foreshortening does not hide the axis behind its joint.
    let reach = metre * (0.9 / x.hypot(y)).clamp(1.0, 2.0);
    let on_axis = |pixels: f64| along(joint.position, pixels * reach, axis);
    match joint.kind {
        // Seen along its axis, the joint has its arrow around the circle instead of beyond it.
        JointKind::Revolute if dot(axis, camera.view.into).abs() >= 0.9 => {
            sheet.sense(&camera.all(&turn(joint.position, axis, (JOINT + 6.0) * metre, camera.view)));
            sheet.revolute(at);
            at
        }
        JointKind::Revolute => {
            let covered = |side: f64| {
                let center = camera.at(on_axis(side * SENSE_AT));
                sheet.obstacles.cost(Frame::sized(center, [SENSE; 2]))
            };
            let side = if covered(-1.0) < covered(1.0) { -1.0 } else { 1.0 };
            sheet.axis_line(&[camera.at(on_axis(-side * AXIS_BEHIND)), camera.at(on_axis(side * AXIS_AHEAD))]);
            let center = on_axis(side * SENSE_AT);
            sheet.sense(&camera.all(&turn(center, axis, SENSE * metre, camera.view)));
            sheet.revolute(at);
            camera.at(center)
        }
        JointKind::Spherical => {
            sheet.spherical(at);
            at
        }
        JointKind::Prismatic => {
            let ahead = camera.at(on_axis(AXIS_AHEAD));
            sheet.arrow(&[camera.at(on_axis(-AXIS_BEHIND)), ahead], INK, 1.2);
            sheet.prismatic(at, direction(at, ahead).0);
            at
        }
    }
}

/// Three quarters of a circle about an axis, in the positive sense, ending in front.
fn turn(center: Vector, axis: Vector, radius: f64, view: View) -> Vec<Vector> {
    let seen = cross(axis, view.into);
    let Some(aside) = unit(seen).or_else(|| unit(cross(axis, view.right))) else { return Vec::new() };
    let front = cross(axis, aside);
    let point = |i: i32| {
        let (sin, cos) = (f64::from(i) * 10.0f64).to_radians().sin_cos();
        along(along(center, radius * cos, aside), radius * sin, front)
    };
    (-13..=14).map(point).collect()
}

/// Along the last piece of the body that ends at the gripper.
fn gripper_direction(robot: &RobotDrawing, camera: &Camera, gripper: Vector) -> Point {
    let ends = robot.links.iter().filter(|link| link.name != WORLD).filter_map(|link| match link.points[..] {
        [.., before, last] => Some((before, last)),
        _ => None,
    });
    let nearer = |a: (Vector, Vector), b: (Vector, Vector)| {
        if distance(b.1, gripper) < distance(a.1, gripper) { b } else { a }
    };
    let Some((before, last)) = ends.reduce(nearer) else { return [1.0, 0.0] };
    let from = if distance(last, gripper) < distance(before, gripper) { before } else { last };
    direction(camera.at(from), camera.at(gripper)).0
}

/// Names, the important ones first; answers those that find no room. What all names of bodies and joints begin with is left out.
fn names(robot: &RobotDrawing, camera: &Camera, tips: &[Point], sheet: &mut Sheet, font: &Font) -> Vec<String> {
    let mut requests = Vec::new();
    let links = || robot.links.iter().filter(|link| link.name != WORLD && !link.points.is_empty());
    let all: Vec<&str> = links().map(|link| &*link.name).chain(robot.joints.iter().map(|joint| &*joint.name)).collect();
    let shared = shared_beginning(&all);
    for (joint, tip) in robot.joints.iter().zip(tips) {
        let beside = vec![(*tip, 0.0), (camera.at(joint.position), JOINT)];
        let text = subscripted(joint.name.get(shared..).unwrap_or_default());
        requests.push(Request { text, size: NAME_SIZE, color: INK, beside, clear: 9.0, optional: false });
    }
    if let Some(gripper) = robot.gripper {
        let beside = vec![(camera.at(gripper), 0.0)];
        requests.push(Request { text: "H".into(), size: NAME_SIZE, color: INK, beside, clear: 10.0, optional: false });
    }
    for element in &robot.elements {
        let (_, ends) = signed_piece(&camera.all(&element.points()));
        let half = match element.shape {
            ElementShape::Turn => [SPIRAL; 2],
            ElementShape::Slide(_) => [SLIDE; 2],
            ElementShape::Bushing => [RING; 2],
            ElementShape::Line | ElementShape::Cable(_) => element_half(ends, &element.sign),
        };
        // The sign, not the line through it, is what the name stands beside.
        let is_sign = |at: &Point| direction(middle(ends), *at).1 <= half[0];
        let beside = middles(&ends).into_iter().map(|at| (at, if is_sign(&at) { half[1] } else { 0.0 })).collect();
        let text = element.name.clone();
        requests.push(Request { text, size: NAME_SIZE, color: ELEMENT, beside, clear: 9.0, optional: false });
    }
    let mut seen = std::collections::HashSet::new();
    for link in links() {
        if seen.insert(link.name.as_str()) {
            let beside = middles(&camera.all(longest(&link.points))).into_iter().map(|at| (at, 0.0)).collect();
            let text = link.name.get(shared..).unwrap_or_default().to_owned();
            requests.push(Request { text, size: LINK_SIZE, color: LINK_NAME, beside, clear: 7.5, optional: true });
        }
    }
    requests.retain(|request| !request.text.is_empty());
    requests.retain(|request| !sheet.obstacles.place(&mut sheet.scene, font, request));
    requests.into_iter().map(|request| request.text).collect()
}

/// Some names; of many the first.
fn listed(names: &[String]) -> String {
    let first = names[..names.len().min(MOST_LISTED)].join(", ");
    match names.len().saturating_sub(MOST_LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// Length of what all of several names begin with, up to a `_` before a letter.
fn shared_beginning(names: &[&str]) -> usize {
    let Some((first, others)) = names.split_first().filter(|(_, others)| !others.is_empty()) else { return 0 };
    let is_shared = |end: &usize| {
        others.iter().all(|name| name.starts_with(&first[..*end]))
            && names.iter().all(|name| name[*end..].starts_with(char::is_alphabetic))
    };
    first.rmatch_indices('_').map(|(at, _)| at + 1).find(is_shared).unwrap_or(0)
}

/// The longest piece of an element's line, which has the sign of its law, and its place among them.
fn signed_piece(points: &[Point]) -> (usize, [Point; 2]) {
    let pieces = points.windows(2).map(|two| [two[0], two[1]]).enumerate();
    let length = |[a, b]: [Point; 2]| direction(a, b).1;
    let longer = |a: (usize, [Point; 2]), b: (usize, [Point; 2])| if length(b.1) > length(a.1) { b } else { a };
    pieces.reduce(longer).expect("two ends")
}

/// Half length and half height of an element's sign.
fn element_half([from, to]: [Point; 2], sign: &ElementSign) -> [f64; 2] {
    let (along, length) = direction(from, to);
    element::draw(sign, from, along, length).half.unwrap_or_default()
}

fn middle([a, b]: [Point; 2]) -> Point {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

/// Places to name a line: its middle first.
fn middles(line: &[Point]) -> Vec<Point> {
    match line {
        [a, b] => [0.5, 0.4, 0.6, 0.3, 0.7].map(|t| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]).to_vec(),
        points => points.to_vec(),
    }
}

/// The longest straight piece of a polyline, or its one point.
fn longest(points: &[Vector]) -> &[Vector] {
    let longer = |a: &[Vector], b: &[Vector]| distance(b[0], b[1]) > distance(a[0], a[1]);
    points.windows(2).reduce(|a, b| if longer(a, b) { b } else { a }).unwrap_or(points)
}

/// "q1" as "q₁"; other names stay.
fn subscripted(name: &str) -> String {
    let mut chars = name.chars();
    let (first, rest) = (chars.next(), chars.as_str().strip_prefix('_').unwrap_or(chars.as_str()));
    match first {
        Some(letter) if letter.is_alphabetic() && matches!(rest.len(), 1..=3) => {
            let subscript = |c: char| c.to_digit(10).and_then(|d| char::from_u32('₀' as u32 + d));
            rest.chars()
                .map(subscript)
                .collect::<Option<String>>()
                .map_or(name.into(), |rest| format!("{letter}{rest}"))
        }
        _ => name.into(),
    }
}

/// The sign of the axes and the scale bar, in a free corner, else below the robot, or beside it where the page has more room there.
fn triad_and_scale(page: Option<[f64; 2]>, camera: &Camera, sheet: &mut Sheet, font: &Font) {
    let arms = AXES.map(|axis| {
        let [x, y] = camera.view.project(axis);
        [TRIAD * x, -TRIAD * y]
    });
    let length = nice_length(SCALE_BAR / camera.scale);
    let bar = length * camera.scale;
    // The sign with its letters takes a square; the bar stands to its right.
    let reach = TRIAD + 14.0;
    let low = |axis: usize| arms.iter().map(|arm| arm[axis]).fold(0.0, f64::min) - 14.0;
    let high = |axis: usize| arms.iter().map(|arm| arm[axis]).fold(0.0, f64::max) + 14.0;
    let text = format!("{length} m");
    let bar_width = bar.max(font.width(&text, LINK_SIZE));
    let [width, height] = [high(0) - low(0) + 18.0 + bar_width, (high(1) - low(1)).min(2.0 * reach)];

    let Frame([left, top, right, bottom]) = sheet.obstacles.bounds();
    let half = [0.5 * width, 0.5 * height];
    let corners = [
        [right - half[0], bottom - half[1]],
        [left + half[0], bottom - half[1]],
        [right - half[0], top + half[1]],
        [left + half[0], top + half[1]],
    ];
    let free = |middle: &&Point| sheet.obstacles.cost(Frame::sized(**middle, [half[0] + 8.0, half[1] + 8.0])) == 0.0;
    let below = [left + half[0], bottom + 16.0 + half[1]];
    let beside = [right + 16.0 + half[0], bottom - half[1]];
    let shrinks =
        |by: Point, [wide, high]: [f64; 2]| ((right - left + by[0]) / wide).max((bottom - top + by[1]) / high);
    let is_wide = page.is_some_and(|page| shrinks([width + 16.0, 0.0], page) < shrinks([0.0, height + 16.0], page));
    let outside = if is_wide { beside } else { below };
    let middle = corners.iter().find(free).copied().unwrap_or(outside);
    sheet.obstacles.frame(Frame::sized(middle, half));

    let origin = [middle[0] - half[0] - low(0), middle[1] - half[1] - low(1)];
    let mut end_on = None;
    for ((arm, axis), name) in arms.iter().zip(AXES).zip(["x", "y", "z"]) {
        let tip = [origin[0] + arm[0], origin[1] + arm[1]];
        let long = arm[0].hypot(arm[1]);
        if long < 4.0 {
            end_on = Some(dot(axis, camera.view.into) < 0.0);
            let at = [origin[0] - 10.0, origin[1] + 11.0];
            sheet.scene.text(Text::new(name, at, LINK_SIZE, Align::Middle));
            continue;
        }
        sheet.arrow(&[origin, tip], INK, 1.3);
        let out = [tip[0] + 8.0 * arm[0] / long, tip[1] + 8.0 * arm[1] / long];
        sheet.scene.text(Text::new(name, [out[0], out[1] + Font::middle(LINK_SIZE)], LINK_SIZE, Align::Middle));
    }
    if let Some(out) = end_on {
        sheet.end_on(origin, out);
    }
    let start = origin[0] + high(0) + 18.0;
    let y = origin[1];
    let scene = &mut sheet.scene;
    scene.line(&[[start, y], [start + bar, y]], Stroke::new(INK, 1.6).butt());
    let ends = [start, start + bar].map(|x| vec![[x, y - 4.0], [x, y + 4.0]]);
    scene.lines(ends.to_vec(), Stroke::new(INK, 1.2).butt());
    scene.text(Text::new(text, [start + 0.5 * bar, y - 7.0], LINK_SIZE, Align::Middle));
}

/// The largest of 1, 2, 5 times a power of ten not above `most`.
fn nice_length(most: f64) -> f64 {
    let exponent = most.log10().floor() as i32;
    let candidates = [5, 2, 1].map(|digit| format!("{digit}e{exponent}").parse::<f64>().unwrap_or(most));
    candidates.into_iter().find(|length| *length <= most).unwrap_or(candidates[2])
}

/// Moves everything onto a page with the title above; one that is too large is shrunk to it.
fn page(robot: &RobotDrawing, sheet: Sheet, font: &Font) -> Scene {
    let Frame([left, top, right, bottom]) = sheet.obstacles.bounds();
    let [paper_width, paper_height] =
        robot.size.map_or([Some(WIDTH), None], |size| size.map(Some)).map(|side| side.map(|mm| mm * PIXELS_PER_MM));
    let paper_width = paper_width.unwrap_or(WIDTH * PIXELS_PER_MM);
    let width = (right - left + 2.0 * BORDER).max(paper_width);
    let title = robot.title.as_deref().unwrap_or_default();
    let lines = wrap_evenly(font, title, TITLE_SIZE, width - 2.0 * BORDER, 3);
    let title_height = if title.is_empty() { 0.0 } else { lines.len() as f64 * TITLE_LINE + 10.0 };
    let height = bottom - top + title_height + 2.0 * BORDER;
    let shrunk = (width / paper_width).max(paper_height.map_or(1.0, |paper| height / paper));
    let mut scene = sheet.scene;
    (scene.width, scene.height) = (shrunk * paper_width, paper_height.map_or(height, |paper| shrunk * paper));
    scene.paper_width = (shrunk > 1.0).then_some(paper_width);
    let free = [scene.width - (right - left), scene.height - title_height - (bottom - top)].map(|free| 0.5 * free);
    scene.shift([free[0] - left, free[1] + title_height - top]);
    scene.title = title.to_owned();
    for (row, line) in lines.iter().enumerate() {
        let at = [0.5 * scene.width, BORDER + row as f64 * TITLE_LINE + TITLE_SIZE - 4.0];
        scene.text(Text::new(line, at, TITLE_SIZE, Align::Middle));
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::difference;

    #[test]
    fn numbers_in_names_become_subscripts() {
        let cases = [("q1", "q₁"), ("q12", "q₁₂"), ("q_3", "q₃"), ("θ2", "θ₂"), ("elbow1", "elbow1"), ("q", "q")];
        for (name, shown) in cases {
            assert_eq!(subscripted(name), shown);
        }
        for name in ["", "qx", "1", "q1234", "joint_2", "q漢"] {
            assert_eq!(subscripted(name), name);
        }
    }

    #[test]
    fn what_all_names_begin_with_is_left_out() {
        let shown =
            |names: &[&str]| names.iter().map(|name| name[shared_beginning(names)..].to_owned()).collect::<Vec<_>>();
        assert_eq!(shown(&["panda_link0", "panda_finger_joint1"]), ["link0", "finger_joint1"]);
        assert_eq!(shown(&["a_b_c", "a_b_d"]), ["c", "d"]);
        for names in [&["joint_1", "joint_2"][..], &["panda_link0"], &["panda_link0", "tool"], &["a_", "a_b"], &[]] {
            assert_eq!(shown(names), names);
        }
    }

    #[test]
    fn scale_bars_are_round() {
        let lengths = [0.09, 0.2, 0.3, 1.0, 7.0, 4e-9, 1.9e5].map(nice_length);
        assert_eq!(lengths, [0.05, 0.2, 0.2, 1.0, 5.0, 2e-9, 1e5]);
    }

    #[test]
    fn the_arrow_turns_in_the_positive_sense() {
        let view = View { right: [1.0, 0.0, 0.0], up: [0.0, 0.0, 1.0], into: [0.0, 1.0, 0.0] };
        for axis in [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.6, 0.0, -0.8]] {
            let points = turn([0.0; 3], axis, 1.0, view);
            for pair in points.windows(2) {
                assert!(dot(cross(pair[0], difference(pair[1], pair[0])), axis) > 0.0);
            }
        }
    }
}
