//! Controllers hold a scene near the triangles, the frame time or the load that is asked for, and rest when it does.

#[path = "../../examples/support/crowd.rs"]
mod crowd;
#[path = "../support/mod.rs"]
mod support;

mod bias;
mod budget;
mod frame_time;
mod scene;
mod stress;
