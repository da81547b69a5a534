//! From an error of the linker or of naga to the file and line a person wrote.
//!
//! naga sees the linked text. The linker keeps the source span of every statement, so the linked text is parsed once more, and the
//! statement that contains the error is found by its rank: both trees list their statements in the same order.

use crate::ShaderError;
use crate::link::LibraryResolver;
use std::error::Error;
use std::ops::Range;
use wesl::syntax::{CompoundStatement, GlobalDeclaration, GlobalDeclarationNode, Span, Statement, StatementNode, TranslationUnit};
use wesl::{BasicSourceMap, Diagnostic, ImportError, ModulePath, ResolveError, SourceMap};

/// The files that took part in linking.
pub(crate) struct Sources<'a> {
    pub root_file: String,
    pub resolver: &'a LibraryResolver<'a>,
}

/// Mangled names back to what the author wrote.
pub(crate) struct Names<'a> {
    pub sourcemap: Option<&'a BasicSourceMap>,
}

impl Names<'_> {
    /// Module (`None` for the root file) and name of a declaration in the linked text.
    pub(crate) fn original<'s>(&'s self, linked: &'s str) -> (Option<&'s ModulePath>, &'s str) {
        self.sourcemap.and_then(|map| map.get_decl(linked)).map_or((None, linked), |(path, name)| (Some(path), name))
    }

    /// Replaces every mangled identifier in a message.
    fn in_message(&self, message: &str) -> String {
        let is_ident = |c: char| c.is_alphanumeric() || c == '_';
        let mut out = String::new();
        let mut rest = message;
        while let Some(start) = rest.find(is_ident) {
            out.push_str(&rest[..start]);
            rest = &rest[start..];
            let end = rest.find(|c| !is_ident(c)).unwrap_or(rest.len());
            out.push_str(self.original(&rest[..end]).1);
            rest = &rest[end..];
        }
        out + rest
    }
}

impl Sources<'_> {
    /// An error that the WESL linker found.
    pub(crate) fn wesl_error(&self, error: wesl::Error) -> ShaderError {
        let diagnostic = Diagnostic::from(error);
        let message = match &*diagnostic.error {
            wesl::Error::ParseError(parse) => parse.error.to_string(),
            other => other.to_string(),
        };
        let detail = &diagnostic.detail;
        let file = detail.module_path.as_ref().map_or_else(|| self.root_file.clone(), |path| self.resolver.file(path));
        let Some(source) = detail.source.as_deref() else { return ShaderError::File { file, message } };
        let offset = detail.span.map(|span| span.start).or_else(|| offset_of(source, &diagnostic.error, detail.declaration.as_deref()));
        located(file, source, offset, message)
    }

    /// An error that naga found in the linked text.
    pub(crate) fn wgsl_error(
        &self,
        names: &Names,
        linked: &TranslationUnit,
        wgsl: &str,
        span: Option<Range<usize>>,
        message: &str,
    ) -> ShaderError {
        let message = names.in_message(message);
        let Some(offset) = span.map(|span| span.start) else { return ShaderError::File { file: self.root_file.clone(), message } };
        let Some((declaration, span)) = source_span(linked, wgsl, offset) else {
            return located(format!("{} (linked)", self.root_file), wgsl, Some(offset), message);
        };
        let path = name_of(declaration).and_then(|name| names.original(&name).0.cloned());
        match path.as_ref().map(|path| (self.resolver.file(path), self.resolver.source(path))) {
            Some((file, Some(source))) => located(file, source, Some(span.start), message),
            _ => match names.sourcemap.and_then(SourceMap::get_default_source) {
                Some(source) => located(self.root_file.clone(), source, Some(span.start), message),
                None => ShaderError::File { file: self.root_file.clone(), message },
            },
        }
    }
}

/// An error and everything that caused it, in one line.
pub(crate) fn chain(error: &(dyn Error + 'static)) -> String {
    std::iter::successors(Some(error), |&error| error.source()).map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// Errors without a span name an item or a module; the place is where the file first writes it.
fn offset_of(source: &str, error: &wesl::Error, declaration: Option<&str>) -> Option<usize> {
    let module_name = |path: &ModulePath| path.components.last().cloned();
    let name = match error {
        wesl::Error::ImportError(
            ImportError::MissingDecl(_, name) | ImportError::DuplicateSymbol(name) | ImportError::Private(name, _),
        ) => Some(name.clone()),
        wesl::Error::ResolveError(ResolveError::ModuleNotFound(path, _))
        | wesl::Error::ImportError(ImportError::ResolveError(ResolveError::ModuleNotFound(path, _))) => module_name(path),
        _ => None,
    };
    name.as_deref().or(declaration).and_then(|name| source.find(name))
}

fn name_of(declaration: &GlobalDeclaration) -> Option<String> {
    let ident = match declaration {
        GlobalDeclaration::Declaration(value) => &value.ident,
        GlobalDeclaration::TypeAlias(alias) => &alias.ident,
        GlobalDeclaration::Struct(structure) => &structure.ident,
        GlobalDeclaration::Function(function) => &function.ident,
        GlobalDeclaration::Void | GlobalDeclaration::ConstAssert(_) => return None,
    };
    Some(ident.name().clone())
}

fn located(file: String, source: &str, offset: Option<usize>, message: String) -> ShaderError {
    let Some(offset) = offset.filter(|&offset| offset <= source.len() && source.is_char_boundary(offset)) else {
        return ShaderError::File { file, message };
    };
    let before = &source[..offset];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let text = source[line_start..].lines().next().unwrap_or_default();
    let column = offset - line_start;
    ShaderError::Source {
        file,
        line: before.matches('\n').count() as u32 + 1,
        column: column as u32 + 1,
        message,
        text: text.trim_end().to_owned(),
    }
}

/// The declaration of `linked` that `offset` in its text `wgsl` belongs to, and the source span of the innermost statement there.
fn source_span<'a>(linked: &'a TranslationUnit, wgsl: &str, offset: usize) -> Option<(&'a GlobalDeclarationNode, Span)> {
    let reparsed: TranslationUnit = wgsl.parse().ok()?;
    let rank = reparsed.global_declarations.iter().position(|declaration| declaration.span().range().contains(&offset))?;
    let original =
        linked.global_declarations.iter().filter(|declaration| !matches!(declaration.node(), GlobalDeclaration::Void)).nth(rank)?;
    let (mut there, mut here) = (Vec::new(), Vec::new());
    statements_of(reparsed.global_declarations[rank].node(), &mut there);
    statements_of(original.node(), &mut here);
    let innermost = there.iter().enumerate().filter(|(_, span)| span.range().contains(&offset)).min_by_key(|(_, span)| span.range().len());
    let span = innermost.and_then(|(statement, _)| here.get(statement)).copied();
    Some((original, span.unwrap_or_else(|| original.span())))
}

fn statements_of(declaration: &GlobalDeclaration, out: &mut Vec<Span>) {
    if let GlobalDeclaration::Function(function) = declaration {
        in_block(&function.body, out);
    }
}

fn in_block(block: &CompoundStatement, out: &mut Vec<Span>) {
    block.statements.iter().for_each(|statement| in_statement(statement, out));
}

fn in_statement(node: &StatementNode, out: &mut Vec<Span>) {
    if matches!(node.node(), Statement::Void) {
        return;
    }
    out.push(node.span());
    match node.node() {
        Statement::Compound(block) => in_block(block, out),
        Statement::If(branch) => {
            in_block(&branch.if_clause.body, out);
            branch.else_if_clauses.iter().for_each(|clause| in_block(&clause.body, out));
            branch.else_clause.iter().for_each(|clause| in_block(&clause.body, out));
        }
        Statement::Switch(switch) => switch.clauses.iter().for_each(|clause| in_block(&clause.body, out)),
        Statement::Loop(repeat) => {
            in_block(&repeat.body, out);
            repeat.continuing.iter().for_each(|continuing| in_block(&continuing.body, out));
        }
        Statement::For(repeat) => {
            repeat.initializer.iter().chain(&repeat.update).for_each(|statement| in_statement(statement, out));
            in_block(&repeat.body, out);
        }
        Statement::While(repeat) => in_block(&repeat.body, out),
        _ => {}
    }
}
