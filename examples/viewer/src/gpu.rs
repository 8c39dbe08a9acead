//! The graphics card: found, opened, and told apart from none at all.

use std::sync::{Arc, Mutex};

/// Why there is no card to draw with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter, not even a software one.
    #[error(
        "no graphics adapter was found ({reason}); a software one will do (Debian: apt-get install mesa-vulkan-drivers libvulkan1)"
    )]
    NoAdapter {
        /// What the system said.
        reason: String,
    },
    /// An adapter that refuses to be opened.
    #[error("the graphics adapter {adapter:?} could not be opened: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What it said.
        reason: String,
    },
}

/// An open card.
#[derive(Clone)]
pub struct Gpu {
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    errors: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the fastest adapter that can draw to a surface, or the fastest at all. Adapters can be chosen by the environment
    /// variables of wgpu (`WGPU_BACKEND`, `WGPU_ADAPTER_NAME`).
    ///
    /// # Errors
    /// There is no adapter, or it refuses.
    #[cfg(feature = "program")]
    pub fn open(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        pollster::block_on(Self::find(instance, surface))
    }

    /// The same for who cannot wait.
    ///
    /// # Errors
    /// There is no adapter, or it refuses.
    pub async fn find(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let named = match std::env::var("WGPU_ADAPTER_NAME") {
            Ok(name) => {
                let all = instance.enumerate_adapters(wgpu::Backends::all()).await;
                let name = name.to_lowercase();
                all.into_iter().find(|adapter| adapter.get_info().name.to_lowercase().contains(&name))
            }
            Err(_) => None,
        };
        let adapter = match named {
            Some(adapter) => adapter,
            None => instance
                .request_adapter(&wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    compatible_surface: surface,
                    ..Default::default()
                })
                .await
                .map_err(|error| GpuError::NoAdapter { reason: one_line(&error) })?,
        };
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                required_features: adapter.features() & wgpu::Features::POLYGON_MODE_LINE,
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|error| GpuError::NoDevice {
                adapter: adapter.get_info().name,
                reason: one_line(&error),
            })?;
        let errors = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&errors);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = sink.lock() {
                first.get_or_insert_with(|| one_line(&error));
            }
        }));
        Ok(Self { adapter, device, queue, errors })
    }

    /// What the adapter is called, and by what it is driven.
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "unknown kind",
        };
        format!("{} ({:?}, {kind}, {})", info.name, info.backend, driver.trim())
    }

    /// The first thing that went wrong on the card since the last call; none in a sound program.
    pub fn error(&self) -> Option<String> {
        self.errors.lock().ok().and_then(|mut first| first.take())
    }
}

/// An instance of the graphics interface, without a display.
pub fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
