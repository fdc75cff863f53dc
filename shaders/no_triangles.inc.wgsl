// Triangles where there are none: in flat clouds and octrees.

fn draw_triangles(batch: VisibleBatch) {}
