//! `#[derive(Params)]`.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Error, Expr, ExprLit, ExprRange, Field, Fields, Lit, LitStr, Meta, RangeLimits};

pub(crate) fn derive(input: &DeriveInput) -> syn::Result<TokenStream> {
    let Data::Struct(data) = &input.data else {
        return Err(Error::new_spanned(&input.ident, "Params is for structs"));
    };
    let Fields::Named(fields) = &data.fields else {
        return Err(Error::new_spanned(&input.ident, "Params needs named fields"));
    };
    let (padding, parameters): (Vec<&Field>, Vec<&Field>) = fields.named.iter().partition(|field| is_padding(field));
    let specs = parameters.iter().map(|field| spec(field)).collect::<syn::Result<Vec<_>>>()?;
    let name = &input.ident;
    let idents: Vec<_> = parameters.iter().map(|field| &field.ident).collect();
    let padding: Vec<_> = padding.iter().map(|field| &field.ident).collect();
    let index = 0..idents.len();
    Ok(quote! {
        impl #name {
            /// Name, description, type, default, range and unit of every parameter.
            pub const SPEC: &'static [::kajo_params::ParamSpec] = &[#(#specs),*];

            /// Reads `name = value` pairs; what is not given keeps its default.
            ///
            /// # Errors
            /// Unknown or repeated names, values of the wrong type or out of range.
            pub fn from_pairs(pairs: &[(&str, &str)]) -> ::core::result::Result<Self, ::kajo_params::ParamError> {
                ::core::result::Result::Ok(Self::from_values(&::kajo_params::ParamValues::from_pairs(Self::SPEC, pairs)?))
            }

            /// From checked values of the same `SPEC`.
            pub fn from_values(values: &::kajo_params::ParamValues) -> Self {
                <Self as ::kajo_params::ParamSet>::from_values(values)
            }

            /// The values, without their types.
            pub fn to_values(&self) -> ::kajo_params::ParamValues {
                <Self as ::kajo_params::ParamSet>::to_values(self)
            }
        }

        impl ::kajo_params::ParamSet for #name {
            const SPEC: &'static [::kajo_params::ParamSpec] = #name::SPEC;

            fn from_values(values: &::kajo_params::ParamValues) -> Self {
                let values = values.values_of(Self::SPEC);
                Self {
                    #(#idents: ::kajo_params::ParamType::from_value(values[#index]),)*
                    #(#padding: ::core::default::Default::default(),)*
                }
            }

            fn to_values(&self) -> ::kajo_params::ParamValues {
                ::kajo_params::ParamValues::new(Self::SPEC, ::std::vec![#(::kajo_params::ParamType::to_value(self.#idents)),*])
            }
        }

        impl ::core::default::Default for #name {
            fn default() -> Self {
                Self::from_values(&::kajo_params::ParamValues::defaults(Self::SPEC))
            }
        }
    })
}

fn is_padding(field: &Field) -> bool {
    field.ident.as_ref().is_some_and(|ident| ident.to_string().starts_with('_'))
}

fn spec(field: &Field) -> syn::Result<TokenStream> {
    let (mut default, mut range, mut unit) = (None, None, LitStr::new("", proc_macro2::Span::call_site()));
    let attribute = field
        .attrs
        .iter()
        .find(|attribute| attribute.path().is_ident("param"))
        .ok_or_else(|| Error::new_spanned(field, "a parameter needs #[param(default = …, range = a..=b)]"))?;
    attribute.parse_nested_meta(|meta| {
        if meta.path.is_ident("default") {
            default = Some(meta.value()?.parse::<Expr>()?);
        } else if meta.path.is_ident("range") {
            let value = meta.value()?;
            range = match value.parse::<Expr>()? {
                Expr::Range(ExprRange { start: Some(min), limits: RangeLimits::Closed(_), end: Some(max), .. }) => Some((min, max)),
                other => return Err(Error::new_spanned(other, "a range is written a..=b")),
            };
        } else if meta.path.is_ident("unit") {
            unit = meta.value()?.parse()?;
        } else {
            return Err(meta.error("expected default, range or unit"));
        }
        Ok(())
    })?;
    let default = default.ok_or_else(|| Error::new_spanned(attribute, "a parameter needs a default"))?;
    let default = match &default {
        Expr::Path(variant) => quote! { #variant as usize as f64 },
        Expr::Lit(ExprLit { lit: Lit::Bool(value), .. }) => quote! { #value as u8 as f64 },
        number => quote! { #number as f64 },
    };
    let range = match range {
        Some((min, max)) => quote! { ::core::option::Option::Some((#min as f64, #max as f64)) },
        None => quote! { ::core::option::Option::None },
    };
    let name = field.ident.as_ref().expect("named fields have names").to_string();
    let doc = description(field)?;
    let ty = &field.ty;
    Ok(quote! { ::kajo_params::ParamSpec::new(#name, #doc, <#ty as ::kajo_params::ParamType>::TYPE, #default, #range, #unit) })
}

/// The doc comment in one line.
fn description(field: &Field) -> syn::Result<String> {
    let lines = field.attrs.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(doc) if doc.path.is_ident("doc") => match &doc.value {
            Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value().trim().to_owned()),
            _ => None,
        },
        _ => None,
    });
    let text = lines.collect::<Vec<_>>().join(" ").trim().to_owned();
    if text.is_empty() { Err(Error::new_spanned(field, "a parameter needs a doc comment: users read it")) } else { Ok(text) }
}
