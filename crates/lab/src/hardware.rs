//! Hardware points: the pipeline that the method `point-list` and the benchmarks share.

use render::gpu::Gpu;

/// Depths of hardware points.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What one pipeline of hardware points differs in from another.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// With an entry point `fragment`.
    pub module: &'a wgpu::ShaderModule,
    /// The vertices' entry point.
    pub vertex: &'a str,
    /// What vertices are read from.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Of the image.
    pub format: wgpu::TextureFormat,
    /// Which of two depths stays.
    pub nearer: wgpu::CompareFunction,
}

/// A pipeline that draws points of one pixel, hidden by [`DEPTH_FORMAT`] depths.
#[must_use]
pub fn pipeline(gpu: &Gpu, points: Points) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions::default;
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("point-list"),
        layout: None,
        vertex: wgpu::VertexState {
            module: points.module,
            entry_point: Some(points.vertex),
            compilation_options: compilation_options(),
            buffers: points.buffers,
        },
        fragment: Some(wgpu::FragmentState {
            module: points.module,
            entry_point: Some("fragment"),
            compilation_options: compilation_options(),
            targets: &[Some(points.format.into())],
        }),
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::PointList,
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(points.nearer),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        multiview_mask: None,
        cache: None,
    })
}
