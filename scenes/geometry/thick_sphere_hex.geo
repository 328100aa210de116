// Thick sphere, see thick_sphere.geo, in hexahedra: the eighth in three blocks of
// n boxes each way.
//
// Regions: body. Surfaces: inner, outer, symmetry_x (x = 0, hold u_x),
// symmetry_y, symmetry_z.
SetFactory("Built-in");
DefineConstant[ n = {4, Name "Parameters/boxes along an edge"} ];
Include "options.geo";

Point(1) = {0, 0, 0};
s2 = 1 / Sqrt(2);
s3 = 1 / Sqrt(3);
For i In {0:1}
  r = 1 + i;
  p = 100 * (i + 1);
  Point(p + 1) = {r, 0, 0};
  Point(p + 2) = {0, r, 0};
  Point(p + 3) = {0, 0, r};
  Point(p + 4) = {r * s2, r * s2, 0};
  Point(p + 5) = {0, r * s2, r * s2};
  Point(p + 6) = {r * s2, 0, r * s2};
  Point(p + 7) = {r * s3, r * s3, r * s3};
  Circle(p + 1) = {p + 1, 1, p + 4};
  Circle(p + 2) = {p + 4, 1, p + 2};
  Circle(p + 3) = {p + 2, 1, p + 5};
  Circle(p + 4) = {p + 5, 1, p + 3};
  Circle(p + 5) = {p + 3, 1, p + 6};
  Circle(p + 6) = {p + 6, 1, p + 1};
  Circle(p + 7) = {p + 4, 1, p + 7};
  Circle(p + 8) = {p + 5, 1, p + 7};
  Circle(p + 9) = {p + 6, 1, p + 7};
  Curve Loop(p + 1) = {p + 1, p + 7, -(p + 9), p + 6};
  Curve Loop(p + 2) = {p + 2, p + 3, p + 8, -(p + 7)};
  Curve Loop(p + 3) = {p + 4, p + 5, p + 9, -(p + 8)};
  For k In {1:3}
    Surface(p + k) = {p + k} In Sphere {1};
  EndFor
EndFor
For k In {1:7}
  Line(300 + k) = {100 + k, 200 + k};
EndFor
// Sides of the three blocks: each stands on an inner arc.
ends() = {1, 4,  4, 2,  2, 5,  5, 3,  3, 6,  6, 1,  4, 7,  5, 7,  6, 7};
For k In {1:9}
  a = ends(2 * k - 2);
  b = ends(2 * k - 1);
  Curve Loop(300 + k) = {100 + k, 300 + b, -(200 + k), -(300 + a)};
  Plane Surface(300 + k) = {300 + k};
EndFor
Surface Loop(1) = {101, 201, 301, 307, 309, 306};
Surface Loop(2) = {102, 202, 302, 303, 308, 307};
Surface Loop(3) = {103, 203, 304, 305, 309, 308};
For k In {1:3}
  Volume(k) = {k};
EndFor
Transfinite Curve{101:109, 201:209} = n + 1;
Transfinite Curve{301:307} = n + 1 Using Progression 2^(1 / n);
Transfinite Surface "*";
Recombine Surface "*";
Transfinite Volume "*";
Physical Volume("body", 1) = {1:3};
Physical Surface("inner", 2) = {101:103};
Physical Surface("outer", 3) = {201:203};
Physical Surface("symmetry_x", 4) = {303, 304};
Physical Surface("symmetry_y", 5) = {305, 306};
Physical Surface("symmetry_z", 6) = {301, 302};
