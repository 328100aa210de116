// Cook's membrane as a solid, see cook3d.geo, in hexahedra: 4n along, 4n across, n through the thickness.
//
// Regions: body. Surfaces: clamped (x = 0), loaded (x = 48 mm), faces (z = 0 and
// z = 10 mm), edges (upper and lower). For even n the probes (48, 60, 5) and
// (48, 52, 5) mm are nodes.
SetFactory("Built-in");
DefineConstant[ n = {2, Name "Parameters/boxes through the thickness"} ];
DefineConstant[ thickness = {0.010, Name "Parameters/thickness [m]"} ];
DefineConstant[ layers = {n, Name "Parameters/layers"} ];
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
Transfinite Curve{1, 3, 2, 4} = 4 * n + 1;
Transfinite Surface{1};
Recombine Surface{1};
slab() = Extrude{0, 0, thickness}{ Surface{1}; Layers{layers}; Recombine; };

// An extrusion lists: far face, volume, then one side for each curve of the loop.
Physical Volume("body", 1) = {slab(1)};
Physical Surface("clamped", 2) = {slab(5)};
Physical Surface("loaded", 3) = {slab(3)};
Physical Surface("faces", 4) = {1, slab(0)};
Physical Surface("edges", 5) = {slab(2), slab(4)};

ReverseMesh Surface{1};    // so that every surface faces outward
