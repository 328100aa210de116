// Solid ball of radius 50 mm about the origin.
//
// Regions: body. Surfaces: skin.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0105, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

Sphere(1) = {0, 0, 0, 0.05};

Physical Volume("body", 1) = {1};
Physical Surface("skin", 2) = Abs(Boundary{ Volume{1}; });

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{1};
