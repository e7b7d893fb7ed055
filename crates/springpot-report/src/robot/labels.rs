//! Names beside what they name, clear of lines and of one another.

use crate::draw::{Align, Color, Font, Point, Scene, Stroke, Text};

const GREY: Color = Color(0x90, 0x90, 0x90);
/// Blank kept around a label.
const PAD: f64 = 2.5;
/// Cost of a label that touches something; below, a label is clear.
const TOUCHES: f64 = 50.0;
/// Steps away from what it names that are always tried for a label, and at most.
const NEAR: i32 = 5;
const FARTHEST: i32 = 12;
/// Lines and frames among which it is worth while to search that far.
const FEW: usize = 600;

/// An axis-parallel box: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame(pub(super) [f64; 4]);

/// A name that wants a place.
pub(super) struct Request {
    pub(super) text: String,
    pub(super) size: f64,
    pub(super) color: Color,
    /// Points it may stand beside, the best first, and how far what it names reaches from each.
    pub(super) beside: Vec<(Point, f64)>,
    /// Free distance from those points.
    pub(super) clear: f64,
    /// Is left out rather than drawn over something.
    pub(super) optional: bool,
}

/// What labels must not cover.
#[derive(Default)]
pub(super) struct Obstacles {
    lines: Vec<(Point, Point, f64)>,
    frames: Vec<Frame>,
}

impl Obstacles {
    pub(super) fn line(&mut self, points: &[Point], width: f64) {
        let half = 0.5 * width;
        self.lines.extend(points.windows(2).map(|pair| (pair[0], pair[1], half)));
        if let [point] = points {
            self.lines.push((*point, *point, half));
        }
    }

    pub(super) fn frame(&mut self, frame: Frame) {
        self.frames.push(frame);
    }

    /// The smallest frame around everything.
    pub(super) fn bounds(&self) -> Frame {
        let lines = self.lines.iter().flat_map(|(a, b, half)| [Frame::around(*a, *half), Frame::around(*b, *half)]);
        let all = lines.chain(self.frames.iter().copied());
        all.reduce(Frame::union).unwrap_or(Frame([0.0; 4]))
    }

    /// How much a frame covers.
    pub(super) fn cost(&self, frame: Frame) -> f64 {
        let lines = self.lines.iter().map(|(a, b, half)| {
            let inside = frame.grown(*half + PAD).length_inside(*a, *b);
            if inside > 0.0 { TOUCHES + inside } else { 0.0 }
        });
        let frames = self.frames.iter().map(|other| {
            let overlap = frame.grown(PAD).overlap(*other);
            if overlap > 0.0 { 2.0 * TOUCHES + overlap } else { 0.0 }
        });
        lines.sum::<f64>() + frames.sum::<f64>()
    }

    /// Cost of a thin line through frames; the one that it ends in is what it points at.
    fn crossed(&self, from: Point, to: Point) -> f64 {
        let others = self.frames.iter().filter(|frame| frame.nearest(to) != to);
        TOUCHES * others.filter(|frame| frame.length_inside(from, to) > 0.0).count() as f64
    }

    /// Finds the best place, draws the name, with a thin line to what it names where that is far, and keeps the place. Whether there
    /// was one.
    pub(super) fn place(&mut self, scene: &mut Scene, font: &Font, request: &Request) -> bool {
        let width = font.width(&request.text, request.size);
        let half = [0.5 * width, Font::middle(request.size) + 1.0];
        let mut best: Option<(f64, Point, (Point, f64))> = None;
        // Far from what it names only where there is no place nearer.
        let farthest = if self.lines.len() + self.frames.len() > FEW { NEAR } else { FARTHEST };
        for ring in 0..farthest {
            if ring >= NEAR && best.is_some_and(|(cost, ..)| cost < TOUCHES) {
                break;
            }
            for (rank, (beside, reach)) in request.beside.iter().enumerate() {
                for direction in 0..16 {
                    let (sin, cos) = (f64::from(direction) * std::f64::consts::TAU / 16.0).sin_cos();
                    let clear = request.clear + 9.0 * f64::from(ring);
                    // The frame, not its middle, keeps the distance.
                    let edge = (half[0] / cos.abs().max(1e-9)).min(half[1] / sin.abs().max(1e-9));
                    let middle = [beside[0] + cos * (clear + edge), beside[1] - sin * (clear + edge)];
                    let order = 0.05 * f64::from((direction + 14) % 16);
                    let frame = Frame::sized(middle, half);
                    let leader = leader(frame, *beside, request.clear + reach);
                    let leader = leader.map_or(0.0, |from| self.crossed(from, *beside));
                    let cost = self.cost(frame) + leader + 3.0 * f64::from(ring) + rank as f64 + order;
                    if best.is_none_or(|(least, ..)| cost < least) {
                        best = Some((cost, middle, (*beside, *reach)));
                    }
                }
            }
        }
        let Some((cost, middle, (beside, reach))) = best else { return false };
        if request.optional && cost >= TOUCHES {
            return false;
        }
        let frame = Frame::sized(middle, half);
        if let Some(near) = leader(frame, beside, request.clear + reach) {
            let far = (near[0] - beside[0]).hypot(near[1] - beside[1]);
            let end = [0, 1].map(|k| beside[k] + reach / far * (near[k] - beside[k]));
            scene.line(&[near, end], Stroke::new(GREY, 0.7).butt());
            self.line(&[near, end], 0.7);
        }
        let at = [middle[0], middle[1] + Font::middle(request.size)];
        scene.text(Text::new(&request.text, at, request.size, Align::Middle).color(request.color).halo());
        self.frame(frame);
        true
    }
}

/// Where the thin line from a name to what it names begins; `None` where they are near enough.
fn leader(frame: Frame, beside: Point, clear: f64) -> Option<Point> {
    let near = frame.nearest(beside);
    ((near[0] - beside[0]).hypot(near[1] - beside[1]) > clear + 16.0).then_some(near)
}

impl Frame {
    fn around([x, y]: Point, half: f64) -> Self {
        Self([x - half, y - half, x + half, y + half])
    }

    pub(super) fn sized([x, y]: Point, [w, h]: [f64; 2]) -> Self {
        Self([x - w, y - h, x + w, y + h])
    }

    fn union(self, other: Self) -> Self {
        let (Self(a), Self(b)) = (self, other);
        Self([a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])])
    }

    fn grown(self, by: f64) -> Self {
        let Self([l, t, r, b]) = self;
        Self([l - by, t - by, r + by, b + by])
    }

    fn overlap(self, other: Self) -> f64 {
        let (Self(a), Self(b)) = (self, other);
        (a[2].min(b[2]) - a[0].max(b[0])).max(0.0) * (a[3].min(b[3]) - a[1].max(b[1])).max(0.0)
    }

    fn nearest(self, point: Point) -> Point {
        let Self([l, t, r, b]) = self;
        [point[0].clamp(l, r), point[1].clamp(t, b)]
    }

    /// Length of the part of the line a–b inside the frame; a point inside counts 1.
    fn length_inside(self, a: Point, b: Point) -> f64 {
        let Self([l, t, r, bottom]) = self;
        let (low, high) = ([l, t], [r, bottom]);
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let d = b[axis] - a[axis];
            let (near, far) = ((low[axis] - a[axis]) / d, (high[axis] - a[axis]) / d);
            if d == 0.0 {
                if a[axis] <= low[axis] || a[axis] >= high[axis] {
                    return 0.0;
                }
            } else {
                enter = enter.max(near.min(far));
                leave = leave.min(near.max(far));
            }
        }
        if leave <= enter { 0.0 } else { 1.0 + (leave - enter) * (b[0] - a[0]).hypot(b[1] - a[1]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_by_frames() {
        let frame = Frame([0.0, 0.0, 10.0, 4.0]);
        assert_eq!(frame.length_inside([-5.0, 2.0], [5.0, 2.0]), 6.0);
        assert_eq!(frame.length_inside([5.0, -2.0], [5.0, 9.0]), 5.0);
        assert_eq!(frame.length_inside([-5.0, 5.0], [15.0, 5.0]), 0.0);
        assert_eq!(frame.length_inside([1.0, 1.0], [1.0, 1.0]), 1.0);
        assert_eq!(frame.length_inside([-9.0, 0.0], [0.0, 9.0]), 0.0);
    }

    #[test]
    fn leaders_are_short_of_other_names() {
        let mut obstacles = Obstacles::default();
        obstacles.frame(Frame::sized([50.0, 0.0], [10.0, 5.0]));
        assert_eq!(obstacles.crossed([0.0, 0.0], [100.0, 0.0]), TOUCHES);
        assert_eq!(obstacles.crossed([0.0, 6.0], [100.0, 6.0]), 0.0);
        // What a leader points at may have a frame about it.
        assert_eq!(obstacles.crossed([0.0, 0.0], [55.0, 0.0]), 0.0);

        let name = Frame::sized([100.0, 0.0], [10.0, 5.0]);
        assert_eq!(leader(name, [50.0, 0.0], 8.0), Some([90.0, 0.0]));
        assert_eq!(leader(name, [70.0, 0.0], 8.0), None);
    }

    #[test]
    fn labels_avoid_lines_and_each_other() {
        let font = Font::load().unwrap();
        let mut obstacles = Obstacles::default();
        obstacles.line(&[[-100.0, 0.0], [100.0, 0.0]], 7.0);
        obstacles.line(&[[0.0, -100.0], [0.0, 100.0]], 7.0);
        let mut scene = Scene::default();
        for name in ["one", "two", "three", "four"] {
            let request = Request {
                text: name.into(),
                size: 12.0,
                color: GREY,
                beside: vec![([0.0, 0.0], 0.0)],
                clear: 8.0,
                optional: false,
            };
            let before = obstacles.frames.len();
            assert!(obstacles.place(&mut scene, &font, &request));
            let placed = obstacles.frames.remove(before);
            assert_eq!(obstacles.cost(placed), 0.0, "{name}");
            obstacles.frame(placed);
        }
    }
}
