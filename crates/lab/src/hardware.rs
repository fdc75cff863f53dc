//! Hardware points: the pipeline that the method `point-list` and the benchmarks share.

use render::gpu::Gpu;

/// Format of the depth buffer of hardware points.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How one pipeline of hardware points differs from another.
#[derive(Clone, Copy, Debug)]
pub struct PointPipeline<'a> {
    /// Shaders, with a fragment entry point named `fragment`.
    pub module: &'a wgpu::ShaderModule,
    /// Name of the vertex entry point.
    pub vertex: &'a str,
    /// Vertex buffers; none if the vertex shader reads the cloud's own planes.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Format of the color image.
    pub format: wgpu::TextureFormat,
    /// Depth comparison that a nearer point passes.
    pub nearer: wgpu::CompareFunction,
}

/// A pipeline that draws points of one pixel with a depth test against a [`DEPTH_FORMAT`] buffer.
#[must_use]
pub fn pipeline(gpu: &Gpu, points: PointPipeline) -> wgpu::RenderPipeline {
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
