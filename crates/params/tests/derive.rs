//! A parameter struct, as techniques declare it.

use kajo_params::{ParamChoice, ParamError, ParamKind, ParamSet as _, ParamValues, Params, Rows, Value};
use kajo_units::Meters;

#[derive(ParamChoice, Clone, Copy, Debug, PartialEq)]
enum Filter {
    BoxFilter,
    Tent,
}

#[derive(Params, Clone, Copy, Debug, PartialEq)]
struct Params {
    /// Radius of the search.
    /// Larger costs more.
    #[param(default = 0.25, range = 0.0..=2.0, unit = "m")]
    search_radius: Meters,
    /// Taps a pixel.
    #[param(default = 16, range = 1..=64)]
    taps: u32,
    /// Shift along depth.
    #[param(default = -2, range = -8..=8)]
    bias: i32,
    /// Random rotation.
    #[param(default = true)]
    rotate: bool,
    /// Weights.
    #[param(default = Filter::Tent)]
    filter: Filter,
    _padding: [u32; 3],
}

#[derive(Params, Clone, Copy, Debug, PartialEq)]
struct NoParams {}

fn error(name: &str, value: &str) -> ParamError {
    Params::from_pairs(&[(name, value)]).unwrap_err()
}

#[test]
fn spec_holds_name_doc_kind_default_and_unit() {
    let spec = &Params::SPEC[0];
    assert_eq!((spec.name, spec.doc, spec.unit), ("search_radius", "Radius of the search. Larger costs more.", "m"));
    assert_eq!((spec.kind, spec.default), (ParamKind::Float { min: 0.0, max: 2.0 }, Value::Float(0.25)));
    assert_eq!(Params::SPEC[4].kind, ParamKind::Choice { names: &["box-filter", "tent"] });
    assert_eq!(Params::SPEC.len(), 5, "padding is no parameter");
}

#[test]
fn default_is_what_the_attributes_say() {
    let expected = Params { search_radius: Meters(0.25), taps: 16, bias: -2, rotate: true, filter: Filter::Tent, _padding: [0; 3] };
    assert_eq!(Params::default(), expected);
    assert_eq!(Params::from_pairs(&[]).unwrap(), expected);
}

#[test]
fn pairs_round_trip() {
    let given = [("search_radius", "0.1"), ("taps", "64"), ("bias", "8"), ("rotate", "false"), ("filter", "box-filter")];
    let params = Params::from_pairs(&given).unwrap();
    assert_eq!(params.filter, Filter::BoxFilter);
    let pairs = params.to_pairs();
    let text: Vec<(&str, &str)> = pairs.iter().map(|(name, value)| (*name, value.as_str())).collect();
    assert_eq!(text, given);
    assert_eq!(Params::from_pairs(&text).unwrap(), params);
    assert_eq!(params.to_values().to_string(), "search_radius=0.1,taps=64,bias=8,rotate=false,filter=box-filter");
}

#[test]
fn json_has_numbers_as_people_wrote_them() {
    let values = ParamValues::from_pairs(Params::SPEC, &[("search_radius", "0.1")]).unwrap();
    let json = serde_json::Value::Object(values.to_json()).to_string();
    assert_eq!(json, r#"{"bias":-2,"filter":"tent","rotate":true,"search_radius":0.1,"taps":16}"#);
}

#[test]
fn unknown_names_suggest_the_nearest() {
    let text = error("serch_radius", "1").to_string();
    assert_eq!(
        text,
        r#"no parameter is called "serch_radius" (did you mean "search_radius"?); there are: "search_radius", "taps", "bias", "rotate", "filter""#
    );
    assert!(matches!(error("zzz", "1"), ParamError::Unknown(unknown) if unknown.nearest.is_none()));
    let text = NoParams::from_pairs(&[("a", "1")]).unwrap_err().to_string();
    assert_eq!(text, "no parameter is called \"a\"; there are none");
}

#[test]
fn values_out_of_range_are_refused_with_the_range() {
    assert_eq!(error("search_radius", "2.1").to_string(), "parameter `search_radius` is 2.1; it must be from 0 to 2 m");
    assert_eq!(error("taps", "0").to_string(), "parameter `taps` is 0; it must be a whole number from 1 to 64");
    assert!(matches!(error("taps", "-1"), ParamError::OutOfRange { .. }));
    assert!(matches!(error("taps", "4294967297"), ParamError::OutOfRange { .. }));
    assert!(matches!(error("bias", "-9"), ParamError::OutOfRange { .. }));
    assert!(Params::from_pairs(&[("search_radius", "2"), ("taps", "64"), ("bias", "-8")]).is_ok(), "both ends are allowed");
}

#[test]
fn nan_infinity_and_garbage_are_refused() {
    for text in ["NaN", "inf", "-inf", "1e999", "", "1,5", "0x10", "wide"] {
        assert!(matches!(error("search_radius", text), ParamError::Malformed { .. }), "{text}");
    }
    for text in ["1.5", "NaN", "99999999999999999999"] {
        assert!(matches!(error("taps", text), ParamError::Malformed { .. }), "{text}");
    }
    assert_eq!(error("rotate", "yes").to_string(), "parameter `rotate` is `yes`; it must be true or false");
    assert_eq!(error("filter", "gauss").to_string(), "parameter `filter` is `gauss`; it must be one of box-filter, tent");
}

#[test]
fn a_name_given_twice_is_refused() {
    let error = Params::from_pairs(&[("taps", "2"), ("taps", "3")]).unwrap_err();
    assert_eq!(error, ParamError::Repeated { name: "taps" });
}

#[derive(Params, Clone, Debug, PartialEq)]
struct Wide {
    /// Reflectance.
    #[param(default = 0.5, range = 0.0..=1.0)]
    color: [f64; 3],
    /// Lobes.
    #[param(default = 0.0, range = -1000.0..=1000.0)]
    lobe: Rows,
    /// Table.
    #[param(default = 0.0)]
    file: &'static str,
    /// Width.
    #[param(default = 0.1, range = 0.0..=1.0)]
    width: f64,
}

#[test]
fn colours_rows_and_paths_are_read_and_written() {
    let given = [("color", "0.1,0.2,0.3"), ("lobe", "-1,-1,1,50"), ("lobe", "1,1,1,2.5"), ("file", "a b.binary"), ("width", "0.1")];
    let wide = Wide::from_pairs(&given).unwrap();
    assert_eq!(wide.color, [0.1, 0.2, 0.3]);
    assert_eq!(wide.lobe.as_slice(), [[-1.0, -1.0, 1.0, 50.0], [1.0, 1.0, 1.0, 2.5]]);
    assert_eq!((wide.file, wide.width), ("a b.binary", 0.1), "0.1 is the f64 nearest to 0.1");
    let pairs = wide.to_values().to_pairs();
    let text: Vec<(&str, &str)> = pairs.iter().map(|(name, value)| (*name, value.as_str())).collect();
    assert_eq!(Wide::from_pairs(&text).unwrap(), wide);
    assert_eq!(Wide::from_pairs(&[("color", "0.25")]).unwrap().color, [0.25; 3]);
    assert_eq!(Wide::default().color, [0.5; 3]);
    let refused = |name: &str, value: &str| Wide::from_pairs(&[(name, value)]).unwrap_err();
    assert_eq!(refused("color", "1,2,3").to_string(), "parameter `color` is 1,2,3; it must be one number or r,g,b, each from 0 to 1");
    for (name, value) in [("color", "1,1"), ("color", "nan"), ("color", ""), ("lobe", "1,2,3"), ("lobe", "1,2,3,x")] {
        assert!(matches!(refused(name, value), ParamError::Malformed { .. }), "{name}={value}");
    }
    assert!(matches!(refused("lobe", "1,1,1,2000"), ParamError::OutOfRange { .. }));
    let many = [("lobe", "1,1,1,1"); Rows::MOST + 1];
    assert!(matches!(Wide::from_pairs(&many).unwrap_err(), ParamError::OutOfRange { .. }), "one row too many");
}
