//! The importer as a whole, on small files made here and on real scenes.

mod assets;
