var searchData=
[
  ['bits_0',['Bits',['../limit_8hpp.html#aab9379077386a577def4b597138d4f65',1,'agrisee::study']]]
];
