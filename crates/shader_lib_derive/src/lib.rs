//! `#[derive(ShaderLayout)]`: the names, offsets and sizes of a `#[repr(C)]` struct, to compare with its WGSL twin.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Error, Fields, parse_macro_input};

/// Implements `kajo_shader_lib::ShaderLayout` for a `#[repr(C)]` struct with named fields.
#[proc_macro_derive(ShaderLayout)]
pub fn shader_layout(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    derive(&input).unwrap_or_else(Error::into_compile_error).into()
}

fn derive(input: &DeriveInput) -> syn::Result<TokenStream> {
    let Data::Struct(data) = &input.data else {
        return Err(Error::new_spanned(&input.ident, "ShaderLayout is for structs"));
    };
    let Fields::Named(fields) = &data.fields else {
        return Err(Error::new_spanned(&input.ident, "ShaderLayout needs named fields"));
    };
    if !is_repr_c(input)? {
        return Err(Error::new_spanned(&input.ident, "ShaderLayout needs #[repr(C)]: without it Rust may reorder fields"));
    }
    let name = &input.ident;
    let text = name.to_string();
    let fields = fields.named.iter().map(|field| {
        let ident = field.ident.as_ref().expect("named fields have names");
        let (text, ty) = (ident.to_string(), &field.ty);
        quote! { (#text, ::core::mem::offset_of!(#name, #ident) as u32, ::core::mem::size_of::<#ty>() as u32) }
    });
    Ok(quote! {
        impl ::kajo_shader_lib::ShaderLayout for #name {
            fn layout() -> ::kajo_shader_lib::RustLayout {
                ::kajo_shader_lib::RustLayout {
                    name: #text,
                    size: ::core::mem::size_of::<#name>() as u32,
                    fields: ::std::vec![#(#fields),*],
                }
            }
        }
    })
}

fn is_repr_c(input: &DeriveInput) -> syn::Result<bool> {
    let mut found = false;
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("repr")) {
        attribute.parse_nested_meta(|meta| {
            found |= meta.path.is_ident("C");
            if meta.input.peek(syn::token::Paren) {
                let _: TokenStream = {
                    let content;
                    syn::parenthesized!(content in meta.input);
                    content.parse()?
                };
            }
            Ok(())
        })?;
    }
    Ok(found)
}
