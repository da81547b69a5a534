//! Linking: WESL in, validated WGSL and its description out.

use crate::diagnose::{self, Sources};
use crate::reflect::{self, Binding, EntryPoint, Override};
use crate::{MODULES, ShaderError, StructLayout, library};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use std::borrow::Cow;
use wesl::syntax::PathOrigin;
use wesl::{CompileOptions, EscapeMangler, Feature, Features, ModulePath, ResolveError, Resolver};

/// Name under which shaders import the library.
const PACKAGE: &str = "shader_lib";

/// A WESL file that is not part of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceFile<'a> {
    /// Name with slashes and without extension, e.g. `shadow/pcss`. A file `reflection/march` is imported as `package::reflection::march`.
    pub name: &'a str,
    /// WESL text.
    pub source: &'a str,
}

/// A linked, validated shader and what it declares.
#[derive(Debug)]
pub struct Linked {
    /// Name of the root file.
    pub name: String,
    /// The linked text. Names of the root file are kept, imported names are mangled.
    pub wgsl: String,
    /// The same as naga's intermediate representation.
    pub module: naga::Module,
    /// What the validator found out about it.
    pub info: ModuleInfo,
    /// Resources that an entry point uses, by group and binding.
    pub bindings: Vec<Binding>,
    /// Entry points, in file order.
    pub entry_points: Vec<EntryPoint>,
    /// Structs that lie in buffers, by name.
    pub structs: Vec<StructLayout>,
    /// Constants a pipeline may set.
    pub overrides: Vec<Override>,
}

impl Linked {
    /// The binding called `name`.
    ///
    /// # Errors
    /// [`ShaderError::Missing`] with the list of names.
    pub fn binding(&self, name: &str) -> Result<&Binding, ShaderError> {
        self.find("binding", &self.bindings, name, |binding| &binding.name)
    }

    /// The entry point called `name`.
    ///
    /// # Errors
    /// [`ShaderError::Missing`] with the list of names.
    pub fn entry_point(&self, name: &str) -> Result<&EntryPoint, ShaderError> {
        self.find("entry point", &self.entry_points, name, |entry| &entry.name)
    }

    /// The struct called `name`: its name in the file that declares it.
    ///
    /// # Errors
    /// [`ShaderError::Missing`] with the list of names.
    pub fn structure(&self, name: &str) -> Result<&StructLayout, ShaderError> {
        self.find("struct in a buffer", &self.structs, name, |layout| &layout.name)
    }

    fn find<'a, T>(&self, what: &'static str, list: &'a [T], name: &str, name_of: impl Fn(&T) -> &String) -> Result<&'a T, ShaderError> {
        list.iter().find(|item| name_of(item) == name).ok_or_else(|| ShaderError::Missing {
            file: self.file(),
            what,
            name: name.to_owned(),
            available: list.iter().map(|item| name_of(item).as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    pub(crate) fn file(&self) -> String {
        format!("{}.wesl", self.name)
    }
}

/// Links the root file `name` against the library. `features` decide `@if` attributes; using one that is not given is an error.
///
/// # Errors
/// [`ShaderError`] with file, line and message, for whatever keeps the shader from being valid.
pub fn link(name: &str, source: &str, features: &[(&str, bool)]) -> Result<Linked, ShaderError> {
    link_with(SourceFile { name, source }, &[], features)
}

/// [`link`], where the root also imports `files` (by `package::` paths or `super::`).
///
/// # Errors
/// As [`link`].
pub fn link_with(root: SourceFile, files: &[SourceFile], features: &[(&str, bool)]) -> Result<Linked, ShaderError> {
    let resolver = LibraryResolver { root, files };
    compile(root.name, &path_of(PathOrigin::Absolute, root.name), &resolver, features, false)
}

/// Links and validates every module of the library by itself, all its declarations included.
///
/// # Errors
/// Of the first module that fails.
pub fn check_library(features: &[(&str, bool)]) -> Result<(), ShaderError> {
    for module in MODULES {
        let resolver = LibraryResolver { root: SourceFile { name: "", source: "" }, files: &[] };
        let path = path_of(PathOrigin::Package(PACKAGE.to_owned()), module.path);
        compile(&format!("{PACKAGE}/{}", module.path), &path, &resolver, features, true)?;
    }
    Ok(())
}

fn compile(
    name: &str,
    root: &ModulePath,
    resolver: &LibraryResolver,
    features: &[(&str, bool)],
    keep_root: bool,
) -> Result<Linked, ShaderError> {
    let flags = features.iter().map(|&(name, on)| (name.to_owned(), Feature::from(on))).collect();
    let options = CompileOptions { keep_root, features: Features { default: Feature::Error, flags }, ..CompileOptions::default() };
    let sources = Sources { root_file: format!("{name}.wesl"), resolver };
    let linked = wesl::compile_sourcemap(root, resolver, &EscapeMangler, &options).map_err(|error| sources.wesl_error(error))?;
    let wgsl = linked.to_string();
    let names = diagnose::Names { sourcemap: linked.sourcemap.as_ref() };

    let module = naga::front::wgsl::parse_str(&wgsl).map_err(|error| {
        let message =
            std::iter::once(error.message().to_owned()).chain(error.notes().map(|note| format!("note: {note}"))).collect::<Vec<_>>();
        let span = error.labels().next().and_then(|(span, _)| span.to_range());
        sources.wgsl_error(&names, &linked.syntax, &wgsl, span, &message.join("; "))
    })?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).map_err(|error| {
        let span = error.spans().filter_map(|(span, _)| span.to_range()).min_by_key(|range| range.len());
        sources.wgsl_error(&names, &linked.syntax, &wgsl, span, &diagnose::chain(error.as_inner()))
    })?;

    let bindings = reflect::bindings(&module, &info, &names);
    let entry_points = reflect::entry_points(&module, &info, &names, &bindings);
    let structs = reflect::structs(&module, &names);
    let overrides = reflect::overrides(&module, &names);
    Ok(Linked { name: name.to_owned(), wgsl, module, info, bindings, entry_points, structs, overrides })
}

/// Finds the text of a module path: in the library for `shader_lib::…`, else among the root and the files beside it.
pub(crate) struct LibraryResolver<'a> {
    root: SourceFile<'a>,
    files: &'a [SourceFile<'a>],
}

impl LibraryResolver<'_> {
    pub(crate) fn source(&self, path: &ModulePath) -> Option<&str> {
        match &path.origin {
            PathOrigin::Package(package) if package == PACKAGE => library::module(&path.components.join("/")).map(|module| module.source),
            PathOrigin::Absolute => {
                std::iter::once(&self.root).chain(self.files).find(|file| components(file.name) == path.components).map(|file| file.source)
            }
            _ => None,
        }
    }

    /// The file of a module path, as messages show it.
    pub(crate) fn file(&self, path: &ModulePath) -> String {
        match &path.origin {
            PathOrigin::Package(package) => format!("{package}/{}.wesl", path.components.join("/")),
            _ => std::iter::once(&self.root)
                .chain(self.files)
                .find(|file| components(file.name) == path.components)
                .map_or_else(|| format!("{path}"), |file| format!("{}.wesl", file.name)),
        }
    }
}

impl Resolver for LibraryResolver<'_> {
    fn resolve_source<'a>(&'a self, path: &ModulePath) -> Result<Cow<'a, str>, ResolveError> {
        self.source(path).map(Cow::Borrowed).ok_or_else(|| {
            let known: Vec<&str> = MODULES.iter().map(|module| module.path).chain(self.files.iter().map(|file| file.name)).collect();
            ResolveError::ModuleNotFound(path.clone(), format!("there are: {}", known.join(", ")))
        })
    }

    fn display_name(&self, path: &ModulePath) -> Option<String> {
        Some(self.file(path))
    }
}

/// `shadow/ray-traced` → `shadow`, `ray_traced`: module names are identifiers.
fn components(name: &str) -> Vec<String> {
    name.split('/').map(|part| part.replace('-', "_")).collect()
}

fn path_of(origin: PathOrigin, name: &str) -> ModulePath {
    ModulePath::new(origin, components(name))
}
