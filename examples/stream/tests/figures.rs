//! Promise: the figures are the same bytes in every run; a simulated line carries no more than its rate.

mod support;

use multires::stream::ClientOptions;
use multires_stream_example::camera::Detail;
use multires_stream_example::figures::Figures;
use multires_stream_example::simulated::{Line, Simulated};
use support::{folder, near, rock};

const LINE: Line = Line { rate: 20_000.0, delay: 50_000 };

#[test]
fn a_simulated_line_is_the_same_in_every_run_and_holds_its_rate() {
    let server = rock(10_000, 1);
    let run = || {
        let mut sim = Simulated::new(&server, ClientOptions::default(), Some(3_000), LINE).unwrap();
        let mut seen = Vec::new();
        for frame in 1..=60 {
            sim.look(&[near(frame as f32 * 0.05)]);
            sim.run(frame * 50_000).unwrap();
            let (bytes, triangles) = (sim.browser().received().bytes, sim.browser().triangles());
            assert!(bytes as f64 <= LINE.rate * frame as f64 * 0.05, "frame {frame}: {bytes} bytes");
            assert!(triangles <= 3_000, "frame {frame}: {triangles} triangles");
            seen.push((bytes, triangles));
        }
        assert_eq!(sim.browser().received().streams, 1);
        seen
    };
    let seen = run();
    assert!(seen.last().unwrap().1 > 1_000);
    assert_eq!(seen, run());
}

#[test]
fn figures_are_the_same_in_every_run() {
    let server = rock(3_000, 1);
    let make = |name: &str| {
        let (folder, mut says) = (folder(name), Vec::new());
        let detail = Detail { at: [0.5, 0.5, 1.0], ..Detail::default() };
        Figures::new(server.clone(), &detail, LINE).unwrap().make(&folder, &mut says).unwrap();
        let files = ["arrival.png", "path.svg", "error.svg", "detail.png"];
        (files.map(|file| std::fs::read(folder.join(file)).unwrap()), says)
    };
    let (files, says) = make("figures_once");
    assert!(files.iter().all(|file| file.len() > 1_000));
    assert!((files, says) == make("figures_twice"));
}
