// Bubble: a thin hemispherical dome on a flanged base plate, closed chamber.
//
// Unit: meter. Axis y, the chamber's flat floor is the plane y = 0, the plate
// lies below it and is held from beneath. A sphere halfway through the dome is
// meshed too: at least two elements across the thin wall at every mesh size.
//
// Regions: body. Surfaces: chamber (closed: dome and floor), clamped (underside
// of the plate), outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0072, Name "Parameters/target edge length [m]"} ];
DefineConstant[ wall = {0.0038, Name "Parameters/dome wall [m]"} ];
Include "options.geo";

inner_radius = 0.038;
outer_radius = inner_radius + wall;
plate_radius = outer_radius + 0.006;
plate = 0.007;

Sphere(1) = {0, 0, 0, outer_radius, 0, Pi/2, 2*Pi};
Sphere(2) = {0, 0, 0, (inner_radius + outer_radius) / 2, 0, Pi/2, 2*Pi};
Sphere(3) = {0, 0, 0, inner_radius, 0, Pi/2, 2*Pi};
Cylinder(4) = {0, 0, -plate,  0, 0, plate,  plate_radius};
BooleanDifference(11) = { Volume{1}; Delete; }{ Volume{2}; };
BooleanDifference(12) = { Volume{2}; Delete; }{ Volume{3}; };
parts() = BooleanFragments{ Volume{11}; Delete; }{ Volume{12, 4, 3}; Delete; };
Rotate{ {1, 0, 0}, {0, 0, 0}, -Pi/2 }{ Volume{parts()}; }    // axis z to y
Include "chamber.geo";

e = 1e-5;
R = plate_radius + e;
clamped() = Surface In BoundingBox {-R, -plate - e, -R,  R, -plate + e, R};
outer() -= clamped();

Physical Volume("body", 1) = {body()};
Physical Surface("chamber", 2) = {chamber()};
Physical Surface("clamped", 3) = {clamped()};
Physical Surface("outer", 4) = {outer()};

// The middle of the plate hardly moves: coarser there.
Field[1] = MathEval;
Field[1].F = Sprintf("%g * (1 + 0.8 * Exp(-(x^2 + z^2) / 0.025^2 - (y + 0.0035)^2 / 0.006^2))", h);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
ReorientMesh Volume{body()};
