// Inflated tube, see tube.geo, in hexahedra: n through the wall, 8n around, 8n along.
//
// Regions: body. Surfaces: chamber (inner wall), ends (both annuli), outer.
SetFactory("Built-in");
DefineConstant[ n = {3, Name "Parameters/boxes through the wall"} ];
Include "options.geo";

inner_radius = 0.010;
outer_radius = 0.018;
length = 0.080;

Point(1) = {0, 0, 0};
For k In {0:3}
  c = Cos(k * Pi / 2);
  s = Sin(k * Pi / 2);
  Point(10 + k) = {inner_radius * s, 0, inner_radius * c};
  Point(20 + k) = {outer_radius * s, 0, outer_radius * c};
EndFor
For k In {0:3}
  m = (k + 1) % 4;
  Circle(10 + k) = {10 + k, 1, 10 + m};
  Circle(20 + k) = {20 + k, 1, 20 + m};
  Line(30 + k) = {10 + k, 20 + k};
EndFor
For k In {0:3}
  m = (k + 1) % 4;
  Curve Loop(1 + k) = {30 + k, 20 + k, -(30 + m), -(10 + k)};
  Plane Surface(1 + k) = {1 + k};
EndFor
Transfinite Curve{10:13, 20:23} = 2 * n + 1;
Transfinite Curve{30:33} = n + 1;
Transfinite Surface "*";
Recombine Surface "*";
body() = {};
far() = {};
outer() = {};
chamber() = {};
For k In {1:4}
  part() = Extrude{0, length, 0}{ Surface{k}; Layers{8 * n}; Recombine; };
  far() += part(0);
  body() += part(1);
  outer() += part(3);
  chamber() += part(5);
EndFor

Physical Volume("body", 1) = {body()};
Physical Surface("chamber", 2) = {chamber()};
Physical Surface("ends", 3) = {1:4, far()};
Physical Surface("outer", 4) = {outer()};

ReverseMesh Surface{1:4};    // so that every surface faces outward
