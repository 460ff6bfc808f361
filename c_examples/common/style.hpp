// Colors and sizes that the plots share.
#pragma once

// One color a curve, told apart also by people who see red and green alike (Okabe and Ito), as gnuplot takes them.
constexpr const char *const curve_colors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#b8a800", "#5a5a5a"};
constexpr const char *const mark_color = "#d22828", *const faint_color = "#dedede", *const soft_color = "#969696",
                            *const ink_color = "#282828";
