// The uniform by which the stages know a sequential point tree.

@group(0) @binding(15) var<uniform> tree: TreeUniform;
