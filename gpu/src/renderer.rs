//! Fragment shaders run off-screen.

use core::fmt;
use std::time::{Duration, Instant};

/// The format of the pictures: no rounding to fewer bits hides a difference.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Bytes of a pixel of [`FORMAT`].
const PIXEL: u32 = 16;

/// Why nothing was rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no Vulkan driver, or none that offers a device.
    NoAdapter(String),
    /// There is a device, but it can't be used.
    Device(String),
    /// A shader or its resources were refused.
    Invalid(String),
    /// The picture couldn't be read back.
    Readback(String),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, why) = match self {
            Self::NoAdapter(why) => ("no Vulkan device", why),
            Self::Device(why) => ("the Vulkan device cannot be used", why),
            Self::Invalid(why) => ("the shader was refused", why),
            Self::Readback(why) => ("the picture could not be read back", why),
        };
        write!(f, "{what}: {why}")
    }
}

impl core::error::Error for GpuError {}

/// The text of a fragment shader.
#[derive(Clone, Copy, Debug)]
pub enum Fragment<'a> {
    /// WGSL with an entry point `shade`.
    Wgsl(&'a str),
    /// GLSL with an entry point `main`.
    Glsl(&'a str),
}

/// A Vulkan device, hardware or software.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
}

/// A fragment shader ready to run over a square picture.
#[derive(Debug)]
pub struct Pass {
    pipeline: wgpu::RenderPipeline,
    bindings: Option<wgpu::BindGroup>,
    target: wgpu::Texture,
}

impl Gpu {
    /// The device that the system prefers; software where there is nothing else.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where there is none, [`GpuError::Device`] where it can't be opened.
    pub fn new() -> Result<Self, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        let info = adapter.get_info();
        let limits =
            wgpu::DeviceDescriptor { required_limits: wgpu::Limits::downlevel_defaults(), ..Default::default() };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&limits)).map_err(|error| GpuError::Device(error.to_string()))?;
        Ok(Self { device, queue, name: format!("{} ({} {})", info.name, info.driver, info.driver_info) })
    }

    /// The name of the device and its driver.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Prepares a shader for pictures of `size` × `size` pixels; `uniforms` go to group 0, binding 0, where the shader has one.
    ///
    /// # Errors
    /// [`GpuError::Invalid`] with the compiler's words.
    pub fn prepare(&self, fragment: Fragment<'_>, uniforms: Option<&[f32]>, size: u16) -> Result<Pass, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = self.pipeline(fragment);
        let bindings = uniforms.map(|numbers| self.bindings(&pipeline, numbers));
        let target = self.target(size);
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Invalid(error.to_string())),
            None => Ok(Pass { pipeline, bindings, target }),
        }
    }

    /// Runs a shader and reads the picture back: red, green, blue and alpha of each pixel, row by row from the top.
    ///
    /// # Errors
    /// [`GpuError::Readback`].
    pub fn render(&self, pass: &Pass) -> Result<Vec<[f32; 4]>, GpuError> {
        let (width, row) = (pass.target.width(), row_bytes(&pass.target));
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row) * u64::from(pass.target.height()),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.encode(pass);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            pass.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            pass.target.size(),
        );
        self.queue.submit([encoder.finish()]);

        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is alive until the result has come; without it nobody is left to tell.
            let _ = sender.send(result);
        });
        self.wait()?;
        receiver.recv().map_err(readback)?.map_err(readback)?;
        let bytes = buffer.get_mapped_range(..).map_err(readback)?;
        let (pixels, row) = (width as usize * PIXEL as usize, row as usize);
        Ok(bytes.chunks_exact(row).flat_map(|line| line[..pixels].chunks_exact(PIXEL as usize).map(pixel)).collect())
    }

    /// The time of one picture without reading it back: the total of `frames` in a row, divided.
    ///
    /// # Errors
    /// [`GpuError::Readback`] when the device is lost.
    pub fn frame_time(&self, pass: &Pass, frames: u32) -> Result<Duration, GpuError> {
        let start = Instant::now();
        for _ in 0..frames {
            self.queue.submit([self.encode(pass).finish()]);
        }
        self.wait()?;
        Ok(start.elapsed() / frames.max(1))
    }

    fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(readback)
    }

    fn encode(&self, pass: &Pass) -> wgpu::CommandEncoder {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let view = pass.target.create_view(&wgpu::TextureViewDescriptor::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        };
        let mut commands = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..wgpu::RenderPassDescriptor::default()
        });
        commands.set_pipeline(&pass.pipeline);
        if let Some(bindings) = &pass.bindings {
            commands.set_bind_group(0, bindings, &[]);
        }
        commands.draw(0..3, 0..1);
        drop(commands);
        encoder
    }

    fn pipeline(&self, fragment: Fragment<'_>) -> wgpu::RenderPipeline {
        let module = |source| self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let vertex = module(wgpu::ShaderSource::Wgsl(include_str!("triangle.wgsl").into()));
        let fragment = module(match fragment {
            Fragment::Wgsl(text) => wgpu::ShaderSource::Wgsl(text.into()),
            Fragment::Glsl(text) => {
                wgpu::ShaderSource::Glsl { shader: text.into(), stage: wgpu::naga::ShaderStage::Fragment, defines: &[] }
            }
        });
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &vertex,
                entry_point: None,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &fragment,
                entry_point: None,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn bindings(&self, pipeline: &wgpu::RenderPipeline, numbers: &[f32]) -> wgpu::BindGroup {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, &bytes);
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        })
    }

    fn target(&self, size: u16) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size.into(), height: size.into(), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }
}

/// Bytes from one row to the next in the buffer that the picture is copied to.
fn row_bytes(target: &wgpu::Texture) -> u32 {
    (target.width() * PIXEL).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

fn pixel(bytes: &[u8]) -> [f32; 4] {
    let (numbers, _) = bytes.as_chunks::<4>();
    core::array::from_fn(|i| numbers.get(i).map_or(f32::NAN, |&number| f32::from_le_bytes(number)))
}

fn readback(error: impl fmt::Display) -> GpuError {
    GpuError::Readback(error.to_string())
}
