//! One widget for each kind of parameter, made from its declaration: name, range, unit, default and description.

use egui::{Button, DragValue, Response, RichText, Slider, TextEdit, Ui};
use kajo_params::{ParamKind, ParamSpec, ParamValues, Value};

/// Ratio of the ends of a range from which a slider is logarithmic.
const LOGARITHMIC: f64 = 1000.0;

/// Room that a slider leaves for its number, and for each letter of the unit, points.
const NUMBER: f32 = 90.0;
const LETTER: f32 = 9.0;

/// Sliders and fields for all parameters. True when one was changed.
pub(crate) fn show_all(ui: &mut Ui, name: &str, params: &mut ParamValues) -> bool {
    let current: Vec<(&'static ParamSpec, Value)> = params.iter().collect();
    let mut changed = false;
    for (spec, value) in current {
        let text = ui.push_id((name, spec.name), |ui| show(ui, spec, value)).inner;
        // Text that is no value of the parameter stays as it was: the widget's range keeps numbers inside, and what is typed may be half done.
        changed |= text.is_some_and(|text| params.set(spec.name, &text).is_ok());
    }
    changed
}

/// The widget of one parameter; the new value as text when it was changed.
fn show(ui: &mut Ui, spec: &ParamSpec, value: Value) -> Option<String> {
    let mut changed = None;
    ui.horizontal(|ui| {
        let label = ui.label(spec.name.replace('_', " "));
        describe(label, spec);
        let back = Button::new(RichText::new("reset").small()).frame(false);
        if value != spec.default && ui.add(back).on_hover_text(format!("Back to {}", quantity(&spec.default, spec))).clicked() {
            changed = Some(spec.default.to_string());
        }
    });
    let edited = ui.horizontal(|ui| edit(ui, spec, value)).inner;
    changed.or(edited)
}

fn edit(ui: &mut Ui, spec: &ParamSpec, value: Value) -> Option<String> {
    let suffix = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    // What does not fit would widen the panel, and a wider panel the slider, frame after frame.
    let number = NUMBER + LETTER * suffix.chars().count() as f32;
    ui.spacing_mut().slider_width = (ui.available_width() - number).max(60.0);
    match (spec.kind, value) {
        (ParamKind::Float { min, max }, Value::Float(mut v)) => {
            let logarithmic = min >= 0.0 && max / min.max(f64::MIN_POSITIVE) >= LOGARITHMIC && max >= LOGARITHMIC;
            let slider = Slider::new(&mut v, min..=max).suffix(suffix).logarithmic(logarithmic).max_decimals(5);
            describe(ui.add(slider), spec).changed().then(|| v.to_string())
        }
        (ParamKind::UInt { min, max }, Value::UInt(mut v)) => {
            let logarithmic = f64::from(max) / f64::from(min.max(1)) >= LOGARITHMIC;
            let slider = Slider::new(&mut v, min..=max).suffix(suffix).logarithmic(logarithmic);
            describe(ui.add(slider), spec).changed().then(|| v.to_string())
        }
        (ParamKind::Int { min, max }, Value::Int(mut v)) => {
            describe(ui.add(Slider::new(&mut v, min..=max).suffix(suffix)), spec).changed().then(|| v.to_string())
        }
        (ParamKind::Bool, Value::Bool(mut v)) => {
            let word = if v { "on" } else { "off" };
            describe(ui.checkbox(&mut v, word), spec).changed().then(|| v.to_string())
        }
        (ParamKind::Choice { names }, Value::Choice { index, name }) => {
            let mut chosen = index;
            egui::ComboBox::from_id_salt("choice").selected_text(name).show_ui(ui, |ui| {
                names.iter().enumerate().for_each(|(i, name)| {
                    ui.selectable_value(&mut chosen, i, *name);
                });
            });
            (chosen != index).then(|| names[chosen].to_owned())
        }
        (ParamKind::Color { min, max }, Value::Color(mut rgb)) => {
            let responses: Vec<Response> =
                rgb.iter_mut().map(|v| ui.add(DragValue::new(v).range(min..=max).speed((max - min) / 200.0))).collect();
            responses.iter().any(Response::changed).then(|| Value::Color(rgb).to_string())
        }
        (_, value) => {
            let mut text = value.to_string();
            let field = ui.add(TextEdit::singleline(&mut text).hint_text(spec.expected()));
            describe(field, spec).changed().then_some(text)
        }
    }
}

/// The parameter's documentation as a tooltip.
fn describe(response: Response, spec: &ParamSpec) -> Response {
    let text = format!("{}\n\n{}; default {}", spec.doc.trim(), capital(&spec.expected()), quantity(&spec.default, spec));
    response.on_hover_text(text)
}

fn quantity(value: &Value, spec: &ParamSpec) -> String {
    if spec.unit.is_empty() { value.to_string() } else { format!("{value} {}", spec.unit) }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
