// Puck: a flat cylinder that a small disk presses on.
//
// Unit: meter. The axis is z; z = 0 is the bottom.
//
// Regions: body. Surfaces: bottom, pressed (the disk in the middle of the top), top
// (the ring around it), side.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0072, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

radius = 0.05;
height = 0.03;
disk = 0.02;

Cylinder(1) = {0, 0, 0, 0, 0, height, radius};
Disk(100) = {0, 0, height, disk};
BooleanFragments{ Volume{1}; Delete; }{ Surface{100}; Delete; }

small = 1e-5;
Physical Volume("body") = Volume{:};
Physical Surface("bottom") = Surface In BoundingBox{-1, -1, -small, 1, 1, small};
Physical Surface("pressed") =
  Surface In BoundingBox{-disk - small, -disk - small, height - small, disk + small, disk + small, height + small};
all_top() = Surface In BoundingBox{-1, -1, height - small, 1, 1, height + small};
inner() = Surface In BoundingBox{-disk - small, -disk - small, height - small, disk + small, disk + small, height + small};
all_top() -= {inner()};
Physical Surface("top") = {all_top()};
every() = Surface{:};
flat() = Surface In BoundingBox{-1, -1, height - small, 1, 1, height + small};
low() = Surface In BoundingBox{-1, -1, -small, 1, 1, small};
every() -= {flat()};
every() -= {low()};
Physical Surface("side") = {every()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{1};
