//! The guide, a chapter a module: the text of `docs/guide`, compiled and run with the tests.
//!
//! | chapter | for |
//! |---|---|
//! | [`start`] | ten minutes: from `cargo add` to a level of detail following the eye |
//! | [`input`] | meshes, attributes, files |
//! | [`assets`] | glTF with skins, animations and morph targets: the same file, lighter |
//! | [`simplification`] | removing detail, and what the result reports |
//! | [`further`] | when simplification gets stuck: every reason, and what helps |
//! | [`tom`] | the totally ordered mesh: any level, any frame |
//! | [`hierarchy`] | the vertex hierarchy: fine where a view needs it |
//! | [`wavelet`] | wavelets on meshes made by subdivision |
//! | [`remeshing`] | any mesh as one made by subdivision, and points that go both ways |
//! | [`many_objects`] | a scene within a frame time or a number of triangles |
//! | [`stream`] | a model that lies elsewhere, over a line |
//! | [`engine`] | what a frame does, and where backends differ |
//! | [`quality`] | measuring what a level has lost |

/// Makes a chapter's module. Links between chapters resolve to these modules.
macro_rules! chapter {
    ($name:ident, $file:literal) => {
        #[doc = "[start]: crate::guide::start"]
        #[doc = "[input]: crate::guide::input"]
        #[doc = "[assets]: crate::guide::assets"]
        #[doc = "[simplification]: crate::guide::simplification"]
        #[doc = "[further]: crate::guide::further"]
        #[doc = "[tom]: crate::guide::tom"]
        #[doc = "[hierarchy]: crate::guide::hierarchy"]
        #[doc = "[hierarchy-views]: crate::guide::hierarchy#views"]
        #[doc = "[hierarchy-limits-and-vertices-that-do-not-jump]: crate::guide::hierarchy#limits-and-vertices-that-do-not-jump"]
        #[doc = "[wavelet]: crate::guide::wavelet"]
        #[doc = "[remeshing]: crate::guide::remeshing"]
        #[doc = "[many_objects]: crate::guide::many_objects"]
        #[doc = "[stream]: crate::guide::stream"]
        #[doc = "[engine]: crate::guide::engine"]
        #[doc = "[quality]: crate::guide::quality"]
        #[doc = ""]
        #[doc = include_str!(concat!("../docs/guide/", $file))]
        pub mod $name {}
    };
}

chapter!(start, "start.md");
chapter!(input, "input.md");
chapter!(assets, "assets.md");
chapter!(simplification, "simplification.md");
chapter!(further, "further.md");
chapter!(tom, "tom.md");
chapter!(hierarchy, "hierarchy.md");
chapter!(wavelet, "wavelet.md");
chapter!(remeshing, "remeshing.md");
chapter!(many_objects, "many_objects.md");
chapter!(stream, "stream.md");
chapter!(engine, "engine.md");
chapter!(quality, "quality.md");
