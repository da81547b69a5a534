//! `#[derive(ParamChoice)]`.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Error, Fields};

pub(crate) fn derive(input: &DeriveInput) -> syn::Result<TokenStream> {
    let Data::Enum(data) = &input.data else {
        return Err(Error::new_spanned(&input.ident, "ParamChoice is for enums"));
    };
    for variant in &data.variants {
        if !matches!(variant.fields, Fields::Unit) || variant.discriminant.is_some() {
            return Err(Error::new_spanned(variant, "a choice has neither fields nor a number"));
        }
    }
    let name = &input.ident;
    let variants: Vec<_> = data.variants.iter().map(|variant| &variant.ident).collect();
    let texts = variants.iter().map(|variant| kebab_case(&variant.to_string()));
    Ok(quote! {
        impl ::kajo_params::ParamType for #name {
            const TYPE: ::kajo_params::ScalarType = ::kajo_params::ScalarType::Choice(&[#(#texts),*]);

            fn from_value(value: ::kajo_params::Value) -> Self {
                const ALL: &[#name] = &[#(#name::#variants),*];
                ALL[value.choice()]
            }

            fn to_value(self) -> ::kajo_params::Value {
                ::kajo_params::Value::Choice { index: self as usize, name: Self::TYPE.choices()[self as usize] }
            }
        }
    })
}

/// `BoxFilter` → `box-filter`.
fn kebab_case(camel: &str) -> String {
    let mut out = String::new();
    for (i, c) in camel.chars().enumerate() {
        if c.is_uppercase() && i > 0 {
            out.push('-');
        }
        out.extend(c.to_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::kebab_case;

    #[test]
    fn variants_are_written_in_kebab_case() {
        assert_eq!(kebab_case("BoxFilter"), "box-filter");
        assert_eq!(kebab_case("Tent"), "tent");
    }
}
