// Flat round puck, radius 50 mm, height 25 mm, standing on z = 0, finer around the middle of its top.
//
// Regions: body. Surfaces: bottom, top, side.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.008, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

Cylinder(1) = {0, 0, 0,  0, 0, 0.025,  0.05};

e = 1e-6;
skin() = Abs(Boundary{ Volume{1}; });
bottom() = Surface In BoundingBox {-1, -1, -e,  1, 1, e};
top() = Surface In BoundingBox {-1, -1, 0.025 - e,  1, 1, 0.025 + e};
side() = skin();
side() -= bottom();
side() -= top();

Physical Volume("body", 1) = {1};
Physical Surface("bottom", 2) = {bottom()};
Physical Surface("top", 3) = {top()};
Physical Surface("side", 4) = {side()};

Field[1] = Ball;
Field[1].XCenter = 0;
Field[1].YCenter = 0;
Field[1].ZCenter = 0.025;
Field[1].Radius = 0.016;
Field[1].Thickness = 0.03;
Field[1].VIn = 0.4 * h;
Field[1].VOut = h;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
ReorientMesh Volume{1};
