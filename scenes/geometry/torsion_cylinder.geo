// Solid cylinder of radius 1 and length 1, for torsion.
//
// Unit: meter (lengths are relative to the radius). Axis z, 0 <= z <= 1. With
// -order 2 the nodes of curved edges lie on the true cylinder.
//
// Regions: body. Surfaces: bottom (z = 0), top (z = 1), side.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.30, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

Cylinder(1) = {0, 0, 0,  0, 0, 1,  1};

e = 1e-5;
skin() = Abs(Boundary{ Volume{1}; });
bottom() = Surface In BoundingBox {-2, -2, -e,  2, 2, e};
top() = Surface In BoundingBox {-2, -2, 1 - e,  2, 2, 1 + e};
side() = skin();
side() -= bottom();
side() -= top();

Physical Volume("body", 1) = {1};
Physical Surface("bottom", 2) = {bottom()};
Physical Surface("top", 3) = {top()};
Physical Surface("side", 4) = {side()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{1};
