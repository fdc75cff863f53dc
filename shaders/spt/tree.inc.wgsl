// What the stages of a sequential point tree know of it.

@group(0) @binding(15) var<uniform> tree: TreeUniform;
