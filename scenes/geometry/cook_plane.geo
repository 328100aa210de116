// Cook's membrane in plane strain: the panel of cook3d.geo as a slab 1 mm thick,
// one layer of elements; hold u_z = 0 on "faces".
//
// Unit: meter (see cook3d.geo). 0 <= z <= 0.001. The probes (48, 60) and
// (48, 52) mm are nodes on both faces.
//
// Regions: body. Surfaces: clamped (x = 0), loaded (x = 48 mm), faces (z = 0 and
// z = 1 mm), edges (upper and lower).
SetFactory("Built-in");
DefineConstant[ h = {0.0030, Name "Parameters/target edge length away from the held edge [m]"} ];
Include "options.geo";

mm = 1e-3;
thickness = 1 * mm;

Point(1) = {0, 0, 0, 0.7 * h};
Point(2) = {48 * mm, 44 * mm, 0, h};
Point(3) = {48 * mm, 52 * mm, 0, h};
Point(4) = {48 * mm, 60 * mm, 0, 0.9 * h};
Point(5) = {0, 44 * mm, 0, 0.4 * h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
slab() = Extrude{0, 0, thickness}{ Surface{1}; Layers{1}; };

// An extrusion lists: far face, volume, then one side for each curve of the loop.
Physical Volume("body", 1) = {slab(1)};
Physical Surface("clamped", 2) = {slab(6)};
Physical Surface("loaded", 3) = {slab(3), slab(4)};
Physical Surface("faces", 4) = {1, slab(0)};
Physical Surface("edges", 5) = {slab(2), slab(5)};

ReverseMesh Surface{1};    // so that every surface faces outward
