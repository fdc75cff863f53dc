//! Pipelines that draw triangles: over a whole image, or what stands in the room.

use super::Gpu;
use super::stage::shader_module;

/// What a pipeline draws with, and into.
#[derive(Debug)]
pub struct Drawing<'a> {
    /// Name that debuggers show.
    pub name: &'static str,
    /// The whole text, prelude included.
    pub wgsl: &'a str,
    /// Entry points of the vertices and of the fragments.
    pub entries: [&'a str; 2],
    /// Layouts of the buffers that vertices are read from.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// The image, if colors are drawn.
    pub target: Option<wgpu::ColorTargetState>,
    /// Format of the depth image, if there is one. It takes all that is drawn, whatever is in it.
    pub depth_format: Option<wgpu::TextureFormat>,
}

impl Drawing<'_> {
    /// Compiles the pipeline.
    #[must_use]
    pub fn pipeline(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let module = shader_module(&gpu.device, self.name, self.wgsl);
        let [vertex, fragment] = self.entries;
        let targets = [self.target.clone()];
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.buffers,
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: if self.target.is_some() { &targets } else { &[] },
            }),
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: self.depth_format.map(|format| wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            multiview_mask: None,
            cache: None,
        })
    }
}
