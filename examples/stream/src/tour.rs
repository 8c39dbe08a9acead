//! A camera's tour on TCP: a picture every so many seconds, and a chart over time at the end.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use multires::lod::Lod;
use multires::view::ObjectView;

use crate::AnyError;
use crate::browser::Browser;
use crate::camera::{Detail, Pose, Scene, Script, VIEWPORT};
use crate::charts::{BLUE, Line as Curve, Panel, svg};
use crate::line::{FRAME, Watch};
use crate::pictures;

/// Silence of the line after which a tour ends, once the camera has stopped.
const QUIET: Duration = Duration::from_millis(1_500);
/// Pixels of a picture.
const PICTURE: [usize; 2] = [640, 360];
/// Time between two lines of the report.
const REPORT: Duration = Duration::from_secs(1);

/// Options of a [`Tour`].
#[derive(Debug, Clone)]
pub struct TourOptions {
    /// Course of the camera.
    pub script: Script,
    /// The detail that the camera comes close to.
    pub detail: Detail,
    /// Largest error on the screen, pixels.
    pub pixels: f32,
    /// Seconds between two pictures; 0 for no pictures.
    pub every: f64,
    /// Folder for pictures and the chart.
    pub out: PathBuf,
}

/// A point of the chart.
#[derive(Debug, Clone, Copy)]
struct Sample {
    seconds: f64,
    bytes: usize,
    triangles: usize,
}

/// Moves the camera, and keeps samples for the chart.
#[derive(Debug)]
pub struct Tour {
    options: TourOptions,
    samples: Vec<Sample>,
    pictures: usize,
    /// Time of the next line of the report.
    next: Duration,
}

impl Tour {
    /// Prepares a tour.
    pub fn new(options: TourOptions) -> Self {
        Self { options, samples: Vec::new(), pictures: 0, next: Duration::ZERO }
    }

    fn report(&mut self, sample: Sample, packets: usize, time: Duration) -> Result<(), AnyError> {
        if time < self.next {
            return Ok(());
        }
        let mut says = std::io::stdout().lock();
        if self.next.is_zero() {
            writeln!(says, "   seconds      bytes    packets  triangles")?;
        }
        self.next = time + REPORT;
        writeln!(says, "{:10.2} {:10} {packets:10} {:10}", sample.seconds, sample.bytes, sample.triangles)?;
        Ok(says.flush()?)
    }

    fn picture(&mut self, browser: &Browser, pose: &Pose, sample: Sample) -> Result<(), AnyError> {
        let Sample { seconds, bytes, triangles } = sample;
        let caption = format!("{seconds:.1} s   {bytes} bytes   {triangles} triangles");
        let file = self.options.out.join(format!("browse-{:03}.png", self.pictures));
        self.pictures += 1;
        let picture = pictures::draw(&browser.client().to_mesh(), pose, PICTURE, 0.6)?;
        pictures::write(&file, &[(picture, caption)], 1)
    }

    /// Writes the chart: triangles, bytes, and the share of frames in which bytes came, over time.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn chart(&self, file: &Path) -> Result<(), AnyError> {
        let panel = |title, unit, most, points| {
            let lines = vec![Curve { name: "", colour: BLUE, points }];
            Panel { title, axes: ["seconds", unit], log: false, most, lines }
        };
        let points = |value: fn(&Sample) -> f64| self.samples.iter().map(|s| (s.seconds, value(s))).collect();
        let frames = (1.0 / FRAME.as_secs_f64()) as usize;
        let busy = self.samples.windows(frames + 1).map(|second| {
            let came = second.windows(2).filter(|pair| pair[1].bytes > pair[0].bytes).count();
            (second[frames].seconds, 100.0 * came as f64 / frames as f64)
        });
        let panels = [
            panel("Triangles drawn", "triangles", None, points(|s| s.triangles as f64)),
            panel("Bytes received", "bytes", None, points(|s| s.bytes as f64)),
            panel("Frames of the last second in which bytes came", "%", Some(110.0), busy.collect()),
        ];
        std::fs::write(file, svg(&panels, (3, 1), (860, 780))?)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(())
    }
}

impl Watch for Tour {
    fn frame(
        &mut self,
        browser: &Browser,
        time: Duration,
        quiet: Duration,
    ) -> Result<Option<Vec<ObjectView>>, AnyError> {
        let TourOptions { script, detail, pixels, every, .. } = self.options;
        let received = browser.received();
        let seconds = time.as_secs_f64();
        let sample = Sample { seconds, bytes: received.bytes, triangles: browser.triangles() };
        self.samples.push(sample);
        self.report(sample, received.packets, time)?;
        // Without a view: the box of the model comes with the first packet.
        let Some(bounds) = browser.client().bounds() else { return Ok(Some(Vec::new())) };
        let pose = script.pose(&Scene::new(bounds, &detail), seconds);
        if every > 0.0 && sample.triangles > 0 && seconds >= self.pictures as f64 * every {
            self.picture(browser, &pose, sample)?;
        }
        let done = seconds >= script.seconds() && quiet >= QUIET;
        Ok(if done { None } else { Some(vec![pose.view(VIEWPORT, pixels)?]) })
    }
}
