//! `hemicube gallery`: pictures that show the techniques at work.

use super::note;
use crate::args::{GalleryVerb, GlobalArgs};
use crate::failure::Failure;
use crate::output::{Target, print, print_json};
use hemicube_gallery::{Exhibit, GalleryError, Request, exhibits};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Lists the exhibits, or draws those named.
pub fn run(args: &GalleryVerb, global: GlobalArgs) -> Result<(), Failure> {
    let Some(folder) = &args.output else {
        let is_drawn = args.size.is_some() || args.seed.is_some() || !args.files.is_empty();
        if is_drawn || !args.names.is_empty() {
            return Err(Failure::Usage(String::from(
                "drawing exhibits needs a folder; add -o DIR",
            )));
        }
        return list(global);
    };
    let chosen = chosen(args, global)?;
    if !folder.is_dir() {
        return Err(Failure::Failed(format!(
            "{}: is no folder; make it first",
            folder.display()
        )));
    }
    let mut written = Vec::new();
    for exhibit in chosen {
        written.extend(draw(exhibit, args, folder)?);
    }
    if global.json {
        return print_json(&json!({ "files": written }));
    }
    let lines: String = written
        .iter()
        .map(|file| format!("wrote     {file}\n"))
        .collect();
    print(&lines)
}

/// The exhibits that the names ask for; without names all that need no file.
fn chosen(args: &GalleryVerb, global: GlobalArgs) -> Result<Vec<&'static Exhibit>, Failure> {
    if args.names.is_empty() {
        let (free, rest): (Vec<&Exhibit>, Vec<&Exhibit>) =
            exhibits().partition(|e| e.needs.is_empty());
        for exhibit in rest {
            note(
                global,
                &format!("{} is left out: it needs {}", exhibit.name, needs(exhibit)),
            );
        }
        return Ok(free);
    }
    let find = |name: &String| {
        let exhibit = exhibits().find(|e| e.name == name).ok_or_else(|| {
            Failure::Usage(format!(
                "there is no exhibit '{name}'; `hemicube gallery` lists them"
            ))
        })?;
        if exhibit.needs.len() == args.files.len() {
            return Ok(exhibit);
        }
        Err(Failure::Usage(if exhibit.needs.is_empty() {
            format!("{name} needs no file; leave --file out")
        } else {
            format!("{name} needs {}, in this order", needs(exhibit))
        }))
    };
    // A name that is given twice is drawn once.
    let is_first = |&(i, name): &(usize, &String)| !args.names[..i].contains(name);
    let names = args.names.iter().enumerate().filter(is_first);
    names.map(|(_, name)| find(name)).collect()
}

/// The options that name an exhibit's files.
fn needs(exhibit: &Exhibit) -> String {
    let options: Vec<String> = exhibit
        .needs
        .iter()
        .map(|file| format!("--file {file}"))
        .collect();
    options.join(" ")
}

/// Draws one exhibit and writes its files; their names.
fn draw(exhibit: &Exhibit, args: &GalleryVerb, folder: &Path) -> Result<Vec<String>, Failure> {
    let request = Request {
        size: args.size.map(|(w, h)| (w as usize, h as usize)),
        seed: args.seed.unwrap_or(0),
        files: args.files.clone(),
    };
    let pieces = (exhibit.draw)(&request).map_err(|error| of_exhibit(exhibit, &error))?;
    let mut written = Vec::new();
    for piece in pieces {
        let path = folder.join(format!("{}{}", exhibit.name, piece.suffix));
        Target::check(&path, &[])?.write(&piece.bytes)?;
        written.push(path.display().to_string());
    }
    Ok(written)
}

fn of_exhibit(exhibit: &Exhibit, error: &GalleryError) -> Failure {
    let message = format!("{}: {error}", exhibit.name);
    match error {
        GalleryError::Size { .. } => Failure::Usage(message),
        _ => Failure::Failed(message),
    }
}

fn list(global: GlobalArgs) -> Result<(), Failure> {
    if global.json {
        let all: Vec<_> = exhibits()
            .map(|e| json!({ "name": e.name, "about": e.about, "needs": e.needs }))
            .collect();
        return print_json(&json!({ "exhibits": all }));
    }
    let width = exhibits().map(|e| e.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for exhibit in exhibits() {
        let _ = writeln!(text, "{:width$}  {}", exhibit.name, exhibit.about);
        if !exhibit.needs.is_empty() {
            let _ = writeln!(text, "{:width$}  needs {}", "", needs(exhibit));
        }
    }
    print(&text)
}
