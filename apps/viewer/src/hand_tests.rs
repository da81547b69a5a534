//! Mouse and keys on the picture, as egui hands them on.

use crate::app::App;
use crate::headless::input;
use crate::layout::{Layout, PRESETS};
use crate::stage::{Source, Stage};
use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, RawInput, TouchPhase, pos2, vec2};
use glam::{UVec2, Vec3};

const SIZE: UVec2 = UVec2::new(800, 300);
/// In the picture, left of the panel.
const MIDDLE: Pos2 = pos2(200.0, 120.0);

/// A viewer that asks nobody anything: its threads have nothing to do while there is no frame to wait for.
struct Hand {
    app: App,
    time: f64,
}

impl Hand {
    fn new() -> Self {
        let mut app = App::new();
        app.model.enter(Stage::load(&Source { reference: "builtin:cornell".into(), environment: None }).unwrap());
        (app.model.judging, app.model.coarseness) = (false, 8);
        let mut hand = Self { app, time: 0.0 };
        (0..3).for_each(|_| hand.frame(Vec::new()));
        hand
    }

    fn frame(&mut self, events: Vec<Event>) {
        self.time += 1.0 / 60.0;
        let raw = RawInput { events, focused: true, ..input(SIZE, self.time, 4096) };
        self.app.frame(raw).drop_without_applying_deltas();
    }

    fn drag(&mut self, button: PointerButton, from: Pos2, to: Pos2) {
        let press = |pressed, pos| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
        self.frame(vec![Event::PointerMoved(from)]);
        self.frame(vec![press(true, from)]);
        self.frame(vec![Event::PointerMoved(from + 0.5 * (to - from))]);
        self.frame(vec![Event::PointerMoved(to)]);
        self.frame(vec![press(false, to)]);
    }

    fn eye_and_target(&self) -> [Vec3; 2] {
        self.app.model.rig.as_ref().unwrap().eye_and_target()
    }
}

#[test]
fn a_drag_on_the_picture_orbits_and_one_on_the_panel_does_not() {
    let mut hand = Hand::new();
    let [eye, target] = hand.eye_and_target();
    hand.drag(PointerButton::Primary, pos2(780.0, 280.0), pos2(770.0, 250.0));
    assert_eq!(hand.eye_and_target()[0], eye, "the panel is no picture");
    hand.drag(PointerButton::Primary, MIDDLE, MIDDLE + vec2(60.0, 20.0));
    let [now, still] = hand.eye_and_target();
    assert!(now.distance(eye) > 0.05 && still.distance(target) < 1e-3, "{now} {still}");
}

#[test]
fn the_right_button_turns_the_head_and_the_middle_one_moves_sideways() {
    let mut hand = Hand::new();
    let [eye, target] = hand.eye_and_target();
    hand.drag(PointerButton::Secondary, MIDDLE, MIDDLE + vec2(30.0, 0.0));
    let [now, turned] = hand.eye_and_target();
    assert!(now == eye && turned.distance(target) > 0.01);
    hand.drag(PointerButton::Middle, MIDDLE, MIDDLE + vec2(30.0, 0.0));
    let [moved, with] = hand.eye_and_target();
    assert!(moved.distance(now) > 0.01 && ((moved - now) - (with - turned)).length() < 1e-3);
}

#[test]
fn the_wheel_goes_nearer_and_keys_fly() {
    let mut hand = Hand::new();
    let [eye, target] = hand.eye_and_target();
    hand.frame(vec![Event::PointerMoved(MIDDLE)]);
    let wheel = Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    };
    hand.frame(vec![wheel]);
    (0..20).for_each(|_| hand.frame(Vec::new()));
    let [near, _] = hand.eye_and_target();
    assert!(near.distance(target) < eye.distance(target), "{near} {eye}");
    let key = |pressed| Event::Key { key: Key::W, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE };
    hand.frame(vec![key(true)]);
    (0..5).for_each(|_| hand.frame(Vec::new()));
    hand.frame(vec![key(false)]);
    let [flown, _] = hand.eye_and_target();
    assert!((flown - near).dot(target - near) > 0.0, "W goes ahead");
    hand.frame(Vec::new());
    assert_eq!(hand.eye_and_target()[0], flown, "until the key is let go");
}

#[test]
fn sliders_between_strips_are_dragged_and_leave_the_camera_alone() {
    let mut hand = Hand::new();
    hand.app.model.layout = Layout::new(PRESETS[1]);
    (0..2).for_each(|_| hand.frame(Vec::new()));
    let eye = hand.eye_and_target()[0];
    let middle = hand.app.model.screen.x as f32 * 0.5;
    hand.drag(PointerButton::Primary, pos2(middle, 100.0), pos2(middle - 80.0, 100.0));
    let expected = (middle - 80.0) / hand.app.model.screen.x as f32;
    assert!((hand.app.model.layout.dividers()[0] - expected).abs() < 0.02, "{:?}", hand.app.model.layout.dividers());
    assert_eq!(hand.eye_and_target()[0], eye);
}
