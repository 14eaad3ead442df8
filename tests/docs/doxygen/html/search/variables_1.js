var searchData=
[
  ['b_0',['b',['../structagrisee_1_1Capsule.html#a1faa290647aeddc1b4478f17711877d0',1,'agrisee::Capsule']]],
  ['base_1',['base',['../structagrisee_1_1study_1_1BasePlace.html#a90dadebe24914de156e4fd0d0c8fc9eb',1,'agrisee::study::BasePlace']]],
  ['bc_2',['bc',['../structagrisee_1_1SeenTriangle.html#a07592e283b3d3bb380876c80c18f43a4',1,'agrisee::SeenTriangle']]],
  ['believed_5fobservable_3',['believed_observable',['../structagrisee_1_1study_1_1CellRecord.html#a8dfcd91951d78bc3b381322861aaaf01',1,'agrisee::study::CellRecord']]],
  ['believed_5fseen_4',['believed_seen',['../structagrisee_1_1study_1_1CellRecord.html#a0e235ecf74b9014316468fcb5fca6fb6',1,'agrisee::study::CellRecord']]],
  ['bias_5',['bias',['../structagrisee_1_1sensor_1_1NoiseParameters.html#a0d80df5a87b13942ed452b0d29d46d01',1,'agrisee::sensor::NoiseParameters']]],
  ['blocked_6',['blocked',['../structagrisee_1_1study_1_1BasePlace.html#a5424dfdd941553a0c061c1792c78c181',1,'agrisee::study::BasePlace']]],
  ['blocked_5fby_7',['blocked_by',['../structagrisee_1_1study_1_1BasePlace.html#a5f68cdc9df0970f36df54bd3ca0e0e97',1,'agrisee::study::BasePlace']]],
  ['bodies_8',['bodies',['../structagrisee_1_1SplitParameters.html#acdb039dd6b6b1e56b85a07ef7707f93f',1,'agrisee::SplitParameters']]],
  ['body_9',['body',['../structagrisee_1_1BodyCandidate.html#a475cd9032cd81dead005253c3ce8512a',1,'agrisee::BodyCandidate::body()'],['../structagrisee_1_1EllipsoidFit.html#ae8be48474ad6f831e23fd05a7b8f5c74',1,'agrisee::EllipsoidFit::body()'],['../structagrisee_1_1Fruit.html#ae2e60f5bf175adfefb26bb850630ca0d',1,'agrisee::Fruit::body()']]],
  ['boundary_10',['boundary',['../structagrisee_1_1see_1_1Frontier.html#a4eb753a835596e9d71bed65478d16fbe',1,'agrisee::see::Frontier']]],
  ['by_5fcolumn_11',['by_column',['../structagrisee_1_1CloudTraits_3_01C_00_01std_1_1enable__if__t_3_01std_1_1is__base__of_3_01Eigen_1e1fadfc2a2b43fa2805de27d6cefa727.html#ac754de2d04aba33ddf435f03bde6e706',1,'agrisee::CloudTraits&lt; C, std::enable_if_t&lt; std::is_base_of&lt; Eigen::DenseBase&lt; C &gt;, C &gt;::value &amp;&amp;(C::RowsAtCompileTime==3||C::ColsAtCompileTime==3)&gt; &gt;']]]
];
