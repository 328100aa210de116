// Splits the list parts() into body() and the surfaces skin() and chamber(). The
// last of parts() is the chamber's void, fragmented with the body: the chamber's
// wall is what both share. The void and flat caps that close it are removed, they
// are not to be meshed. outer() starts as the skin without the chamber.
void = parts(#parts() - 1);
body() = parts();
body() -= {void};
skin() = Abs(CombinedBoundary{ Volume{body()}; });
caps() = Abs(Boundary{ Volume{void}; });
chamber() = caps();
caps() -= skin();
chamber() -= caps();
outer() = skin();
outer() -= chamber();
Delete{ Volume{void}; }
If (#caps() > 0)
  Delete{ Surface{caps()}; }
EndIf
