//! The derives of `kajo_params`: [`Params`] for a struct of parameters, [`ParamChoice`] for an enum of named choices.

mod choice;
mod params;

use syn::{DeriveInput, Error, parse_macro_input};

/// Declares a technique's parameters. Each field has a doc comment (its description) and `#[param(default = …, range = a..=b, unit = "…")]`;
/// numbers need a range, `bool` and choices take none, the unit is optional. Fields whose names start with `_` are padding.
///
/// Gives `Default`, `kajo_params::ParamSet`, and inherent `SPEC`, `from_pairs`, `from_values`, `to_values`.
#[proc_macro_derive(Params, attributes(param))]
pub fn params(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    params::derive(&input).unwrap_or_else(Error::into_compile_error).into()
}

/// Makes a fieldless enum usable as a parameter; `BoxFilter` is written `box-filter` by users.
#[proc_macro_derive(ParamChoice)]
pub fn param_choice(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    choice::derive(&input).unwrap_or_else(Error::into_compile_error).into()
}
