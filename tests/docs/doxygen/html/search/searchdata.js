var indexSectionsWithContent =
{
  0: "abcdefghijklmnopqrstuvwxyz",
  1: "abcdefghijklmnoprstvw",
  2: "a",
  3: "abcdefghijklmnoprstuvw",
  4: "abcdefghijklmnopqrstuvwxyz",
  5: "abcdefghijklmnoprstuvwxyz",
  6: "bcfijlmnprstv",
  7: "dfknoprs",
  8: "abdefgklmnorstuw",
  9: "a",
  10: "a"
};

var indexSectionNames =
{
  0: "all",
  1: "classes",
  2: "namespaces",
  3: "files",
  4: "functions",
  5: "variables",
  6: "typedefs",
  7: "enums",
  8: "enumvalues",
  9: "defines",
  10: "pages"
};

var indexSectionLabels =
{
  0: "All",
  1: "Classes",
  2: "Namespaces",
  3: "Files",
  4: "Functions",
  5: "Variables",
  6: "Typedefs",
  7: "Enumerations",
  8: "Enumerator",
  9: "Macros",
  10: "Pages"
};

