//! Which file uses what of which other file, read from the source by `syn`.
//!
//! A path such as `super::Line` leads to the file that defines the item, through whatever
//! re-exports stand between. A call of a method leads to the file of its `impl` block, which need
//! not be that of the type. Tests inside a file do not count, nor does a `mod` or `pub use` line:
//! a facade names its parts without using them.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::parse::Parser as _;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ImplItem, Item, Token, Type, UseTree, Visibility};

/// A module's path inside the crate, `["delay", "hinge"]`.
pub(crate) type Module = Vec<String>;

/// All files of a crate, and of a program over it.
#[derive(Debug, Default)]
pub(crate) struct House {
    files: BTreeMap<Module, File>,
}

/// One file uses something of another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Import {
    pub(crate) from: Module,
    pub(crate) to: Module,
    /// The path as it was resolved.
    pub(crate) what: String,
}

#[derive(Debug, Default)]
struct File {
    defined: BTreeSet<String>,
    aliases: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    /// Absolute paths of private `use` lines.
    used: Vec<Vec<String>>,
    /// Paths in bodies and signatures, as written, but for `Self`, which is its type.
    named: BTreeSet<Vec<String>>,
    /// Methods of `impl` blocks, each after its type's path as written.
    methods: BTreeSet<Vec<String>>,
    /// Methods that are called on `self`, each after its type's path as written.
    of_self: BTreeSet<Vec<String>>,
    /// Methods that are called on anything.
    called: BTreeSet<String>,
}

/// A type's file, its name, and that of a method.
type Method = (Module, String, String);

impl House {
    /// Of sources by their path below `src`, `delay/hinge.rs`.
    pub(crate) fn of<'a>(sources: impl IntoIterator<Item = (&'a str, String)>) -> Self {
        let sources = sources.into_iter();
        let files = sources.map(|(path, text)| {
            let module = module_of(path);
            let file = File::read(&text, &module).unwrap_or_else(|e| panic!("{path}: {e}"));
            (module, file)
        });
        Self { files: files.collect() }
    }

    /// Every use of one file's items in another, in order, each pair of files once.
    pub(crate) fn imports(&self) -> Vec<Import> {
        let mut found = BTreeMap::new();
        let methods = self.methods();
        for (from, file) in &self.files {
            let named = file.named.iter().filter_map(|path| self.absolute(from, file, path));
            for path in file.used.iter().cloned().chain(named) {
                if let Some(to) = self.home(&path, 0).filter(|to| to != from) {
                    found.entry((from.clone(), to)).or_insert_with(|| path.join("::"));
                }
            }
            let called = file.of_self.iter().chain(&file.named);
            for method in called.filter_map(|path| self.method(from, file, path)) {
                if let Some(to) = methods.get(&method).filter(|to| *to != from) {
                    let what = format!("{}::{}()", method.1, method.2);
                    found.entry((from.clone(), to.clone())).or_insert(what);
                }
            }
        }
        let import = |((from, to), what)| Import { from, to, what };
        found.into_iter().map(import).collect()
    }

    pub(crate) fn len(&self) -> usize {
        self.files.len()
    }

    /// Each file with the methods that it calls, on whatever.
    pub(crate) fn called(&self) -> impl Iterator<Item = (&Module, &BTreeSet<String>)> {
        self.files.iter().map(|(module, file)| (module, &file.called))
    }

    /// Each file with the paths that its bodies and signatures name.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&Module, &BTreeSet<Vec<String>>)> {
        self.files.iter().map(|(module, file)| (module, &file.named))
    }

    /// The file of each method's `impl` block.
    fn methods(&self) -> BTreeMap<Method, Module> {
        let of = |(module, file): (&Module, &File)| {
            let known = file.methods.iter().filter_map(|path| self.method(module, file, path));
            known.map(|method| (method, module.clone())).collect::<Vec<_>>()
        };
        self.files.iter().flat_map(of).collect()
    }

    /// The method at the end of a path after its type; `None` where that is another crate's.
    fn method(&self, from: &Module, file: &File, path: &[String]) -> Option<Method> {
        let (name, of) = path.split_last()?;
        let (last, before) = of.split_last()?;
        if before.is_empty() && file.defined.contains(last) {
            return Some((from.clone(), last.clone(), name.clone()));
        }
        let absolute = self.absolute(from, file, of)?;
        Some((self.home(&absolute, 0)?, absolute.last()?.clone(), name.clone()))
    }

    /// The absolute path of one in a body; `None` for what is no module's.
    fn absolute(&self, from: &Module, file: &File, path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        if let Some(start) = rooted(first, from) {
            return Some(climbed(start, rest));
        }
        let child = [from.as_slice(), std::slice::from_ref(first)].concat();
        let start = if self.files.contains_key(&child) && !rest.is_empty() {
            Some(child)
        } else {
            file.aliases.get(first).cloned()
        };
        start.map(|start| [start.as_slice(), rest].concat())
    }

    /// The file in which the item at the end of an absolute path is defined. A path that ends
    /// at a module leads nowhere: naming it is no use of it yet.
    fn home(&self, path: &[String], depth: usize) -> Option<Module> {
        /// More than re-exports ever stand in a row.
        const DEEP: usize = 8;
        let known = |length: &usize| self.files.contains_key(&path[..*length]);
        let length = (0..=path.len()).rev().find(known)?;
        let (module, rest) = path.split_at(length);
        let (name, behind) = rest.split_first()?;
        let file = &self.files[module];
        if file.defined.contains(name) || depth > DEEP {
            return Some(module.to_vec());
        }
        if let Some(alias) = file.aliases.get(name) {
            return self.home(&[alias.as_slice(), behind].concat(), depth + 1);
        }
        let through = |glob: &Vec<String>| {
            let home = self.home(&[glob.as_slice(), rest].concat(), depth + 1)?;
            self.files[&home].defined.contains(name).then_some(home)
        };
        // An empty path is the crate's root: other crates' items end there.
        let here = (!module.is_empty()).then(|| module.to_vec());
        file.globs.iter().find_map(through).or(here)
    }
}

impl File {
    fn read(text: &str, module: &Module) -> syn::Result<Self> {
        let mut file = Self::default();
        let parsed = syn::parse_file(text)?;
        parsed.items.iter().for_each(|item| file.take(item, module));
        Ok(file)
    }

    fn take(&mut self, item: &Item, module: &Module) {
        if attributes(item).is_some_and(is_test) {
            return;
        }
        let Item::Use(line) = item else {
            self.defined.extend(defined(item));
            return Paths { file: self, of: None }.visit_item(item);
        };
        let private = matches!(line.vis, Visibility::Inherited);
        for leaf in leaves(&line.tree) {
            let Some(path) = from_root(&leaf.path, module) else { continue };
            match leaf.alias {
                None => self.globs.push(path),
                Some(alias) => {
                    self.aliases.insert(alias, path.clone());
                    self.used.extend(private.then_some(path));
                }
            }
        }
    }
}

/// One name that a `use` line brings in; `alias` is `None` for a glob.
struct Leaf {
    path: Vec<String>,
    alias: Option<String>,
}

fn leaves(tree: &UseTree) -> Vec<Leaf> {
    let leaf = |path: Vec<String>, alias| vec![Leaf { path, alias }];
    match tree {
        UseTree::Path(part) => {
            let first = part.ident.to_string();
            let mut found = leaves(&part.tree);
            for leaf in &mut found {
                if leaf.path.is_empty() && leaf.alias.as_deref() == Some("self") {
                    leaf.alias = Some(first.clone());
                }
                leaf.path.insert(0, first.clone());
            }
            found
        }
        UseTree::Group(group) => group.items.iter().flat_map(leaves).collect(),
        UseTree::Glob(_) => leaf(Vec::new(), None),
        UseTree::Name(name) if name.ident == "self" => leaf(Vec::new(), Some("self".to_owned())),
        UseTree::Name(name) => leaf(vec![name.ident.to_string()], Some(name.ident.to_string())),
        UseTree::Rename(name) => leaf(vec![name.ident.to_string()], Some(name.rename.to_string())),
    }
}

/// Collects all paths and calls of an item that is no test.
struct Paths<'a> {
    file: &'a mut File,
    /// The type whose `impl` block this is.
    of: Option<Vec<String>>,
}

impl Paths<'_> {
    fn name(&mut self, path: Vec<String>) {
        let path = match (path.split_first(), &self.of) {
            (Some((first, rest)), Some(of)) if first == "Self" => [of, rest].concat(),
            _ => path,
        };
        self.file.named.insert(path);
    }
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !attributes(item).is_some_and(is_test) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_impl(&mut self, block: &'ast syn::ItemImpl) {
        let before = self.of.take();
        if let Type::Path(of) = &*block.self_ty {
            let of = parts(&of.path);
            let methods = block.items.iter().filter_map(|item| match item {
                ImplItem::Fn(method) if block.trait_.is_none() => Some(&method.sig.ident),
                _ => None,
            });
            let own = methods.map(|name| [of.as_slice(), &[name.to_string()]].concat());
            self.file.methods.extend(own);
            self.of = Some(of);
        }
        visit::visit_item_impl(self, block);
        self.of = before;
    }

    fn visit_impl_item_fn(&mut self, method: &'ast syn::ImplItemFn) {
        if !is_test(&method.attrs) {
            visit::visit_impl_item_fn(self, method);
        }
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let name = call.method.to_string();
        let is_self = matches!(&*call.receiver, Expr::Path(path) if path.path.is_ident("self"));
        if let Some(of) = self.of.as_ref().filter(|_| is_self) {
            self.file.of_self.insert([of.as_slice(), std::slice::from_ref(&name)].concat());
        }
        self.file.called.insert(name);
        visit::visit_expr_method_call(self, call);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.name(parts(path));
        visit::visit_path(self, path);
    }

    fn visit_item_use(&mut self, line: &'ast syn::ItemUse) {
        // Inside a function.
        self.file.named.extend(leaves(&line.tree).into_iter().map(|leaf| leaf.path));
    }

    fn visit_macro(&mut self, found: &'ast syn::Macro) {
        paths_in(found.tokens.clone(), &mut self.file.named);
        // What is no list of expressions, as a pattern, has its paths alone.
        let listed = Punctuated::<Expr, Token![,]>::parse_terminated;
        for argument in listed.parse2(found.tokens.clone()).into_iter().flatten() {
            Paths { file: &mut *self.file, of: self.of.clone() }.visit_expr(&argument);
        }
        visit::visit_macro(self, found);
    }
}

fn parts(path: &syn::Path) -> Vec<String> {
    path.segments.iter().map(|part| part.ident.to_string()).collect()
}

/// Runs of `name::name` in tokens that nobody has parsed.
fn paths_in(tokens: TokenStream, found: &mut BTreeSet<Vec<String>>) {
    let (mut path, mut colons) = (Vec::new(), 0);
    for token in tokens {
        match token {
            TokenTree::Ident(name) => {
                if colons != 2 {
                    found.insert(std::mem::take(&mut path));
                }
                path.push(name.to_string());
                colons = 0;
            }
            TokenTree::Punct(mark) if mark.as_char() == ':' => colons += 1,
            other => {
                found.insert(std::mem::take(&mut path));
                colons = 0;
                if let TokenTree::Group(group) = other {
                    paths_in(group.stream(), found);
                }
            }
        }
    }
    found.insert(path);
}

/// The module that a file below `src` is: the library's root has no name, the program's is its
/// own root.
fn module_of(path: &str) -> Module {
    let path = path.trim_end_matches(".rs").trim_end_matches("/mod");
    path.split('/').filter(|_| path != "lib").map(str::to_owned).collect()
}

/// Where `crate`, the library's name, `self` and `super` lead.
fn rooted(first: &str, module: &Module) -> Option<Module> {
    match first {
        "crate" if module.first().is_some_and(|root| root == "main") => Some(module.clone()),
        "crate" | "tauscope" => Some(Vec::new()),
        "self" => Some(module.clone()),
        "super" => Some(module.split_last()?.1.to_vec()),
        _ => None,
    }
}

/// `rest` after `start`, where `super` leads up.
fn climbed(mut start: Module, rest: &[String]) -> Vec<String> {
    for part in rest {
        if part == "super" {
            start.pop();
        } else {
            start.push(part.clone());
        }
    }
    start
}

/// The absolute path of a `use` line; other crates' lead nowhere, but for children's.
fn from_root(path: &[String], module: &Module) -> Option<Vec<String>> {
    let (first, rest) = path.split_first()?;
    let start = rooted(first, module);
    let child = || [module.as_slice(), std::slice::from_ref(first)].concat();
    Some(climbed(start.unwrap_or_else(child), rest))
}

fn is_test(attributes: &[Attribute]) -> bool {
    let test = |attribute: &Attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    };
    attributes.iter().any(test)
}

fn attributes(item: &Item) -> Option<&[Attribute]> {
    Some(match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => return None,
    })
}

/// The name of an item, but for a module that is a file of its own.
fn defined(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(item) => item.ident.to_string(),
        Item::Enum(item) => item.ident.to_string(),
        Item::Fn(item) => item.sig.ident.to_string(),
        Item::Macro(item) => item.ident.as_ref()?.to_string(),
        Item::Mod(item) if item.content.is_some() => item.ident.to_string(),
        Item::Static(item) => item.ident.to_string(),
        Item::Struct(item) => item.ident.to_string(),
        Item::Trait(item) => item.ident.to_string(),
        Item::Type(item) => item.ident.to_string(),
        _ => return None,
    })
}
