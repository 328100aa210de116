// Cook's membrane in plane strain, see cook_plane.geo, as a grid of nx along and ny across, each box cut from
// its upper left to its lower right corner. Cut the other way, edge-smoothed elements on 6 x 6 boxes are off
// by 11 % in place of 0.2.
//
// Regions: body. Surfaces: clamped (x = 0), loaded (x = 48 mm), faces (z = 0 and
// z = 1 mm), edges (upper and lower). For even ny the probe (48, 52) mm is a node.
SetFactory("Built-in");
DefineConstant[ nx = {6, Name "Parameters/boxes along"} ];
DefineConstant[ ny = {6, Name "Parameters/boxes across"} ];
Include "options.geo";

mm = 1e-3;
Point(1) = {0, 0, 0};
Point(2) = {48 * mm, 44 * mm, 0};
Point(3) = {48 * mm, 60 * mm, 0};
Point(4) = {0, 44 * mm, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = nx + 1;
Transfinite Curve{2, 4} = ny + 1;
Transfinite Surface{1} Left;
slab() = Extrude{0, 0, 1 * mm}{ Surface{1}; Layers{1}; };

// An extrusion lists: far face, volume, then one side for each curve of the loop.
Physical Volume("body", 1) = {slab(1)};
Physical Surface("clamped", 2) = {slab(5)};
Physical Surface("loaded", 3) = {slab(3)};
Physical Surface("faces", 4) = {1, slab(0)};
Physical Surface("edges", 5) = {slab(2), slab(4)};

ReverseMesh Surface{1};    // so that every surface faces outward
