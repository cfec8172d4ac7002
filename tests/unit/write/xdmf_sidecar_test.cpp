#include "write/xdmf_sidecar.hpp"

#include <gmock/gmock.h>

#include "unit/write/support.hpp"

namespace grainvdb::xdmf_sidecar_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(XdmfSidecar, DescribesASeries) {
  OutputLayout layout(Lattice(0.1, {0, 0, 0}));
  layout.first = {0, 0, 0};
  layout.last = {4, 3, 2};
  layout.time_count = 2;
  layout.fields = {testing::meta_of("phi", 1, 0), testing::meta_of("velocity", 3, 0)};
  const std::vector<OutputTime> times{{0.1, 1, 1, 1}, {1e-9, 2, 2, 1}};
  EXPECT_EQ(xdmf_sidecar(layout, times, "fields.hdf"), R"(<?xml version="1.0" ?>
<Xdmf Version="2.0">
<Domain>
<Grid Name="fields" GridType="Collection" CollectionType="Temporal">
<Grid Name="image" GridType="Uniform">
<Time Value="0.1"/>
<Topology TopologyType="3DCoRectMesh" Dimensions="3 4 5"/>
<Geometry GeometryType="ORIGIN_DXDYDZ">
<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">0.05 0.05 0.05</DataItem>
<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">0.1 0.1 0.1</DataItem>
</Geometry>
<Attribute Name="phi" AttributeType="Scalar" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="3 4 5" NumberType="Float" Precision="4">
<DataItem Dimensions="3 4" NumberType="Int" Format="XML">0 0 0 0 1 1 1 1 1 3 4 5</DataItem>
<DataItem Dimensions="2 3 4 5" NumberType="Float" Precision="4" Format="HDF">fields.hdf:/VTKHDF/PointData/phi</DataItem>
</DataItem>
</Attribute>
<Attribute Name="velocity" AttributeType="Vector" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="3 4 5 3" NumberType="Float" Precision="4">
<DataItem Dimensions="3 5" NumberType="Int" Format="XML">0 0 0 0 0 1 1 1 1 1 1 3 4 5 3</DataItem>
<DataItem Dimensions="2 3 4 5 3" NumberType="Float" Precision="4" Format="HDF">fields.hdf:/VTKHDF/PointData/velocity</DataItem>
</DataItem>
</Attribute>
</Grid>
<Grid Name="image" GridType="Uniform">
<Time Value="1e-09"/>
<Topology TopologyType="3DCoRectMesh" Dimensions="3 4 5"/>
<Geometry GeometryType="ORIGIN_DXDYDZ">
<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">0.05 0.05 0.05</DataItem>
<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">0.1 0.1 0.1</DataItem>
</Geometry>
<Attribute Name="phi" AttributeType="Scalar" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="3 4 5" NumberType="Float" Precision="4">
<DataItem Dimensions="3 4" NumberType="Int" Format="XML">1 0 0 0 1 1 1 1 1 3 4 5</DataItem>
<DataItem Dimensions="2 3 4 5" NumberType="Float" Precision="4" Format="HDF">fields.hdf:/VTKHDF/PointData/phi</DataItem>
</DataItem>
</Attribute>
<Attribute Name="velocity" AttributeType="Vector" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="3 4 5 3" NumberType="Float" Precision="4">
<DataItem Dimensions="3 5" NumberType="Int" Format="XML">1 0 0 0 0 1 1 1 1 1 1 3 4 5 3</DataItem>
<DataItem Dimensions="2 3 4 5 3" NumberType="Float" Precision="4" Format="HDF">fields.hdf:/VTKHDF/PointData/velocity</DataItem>
</DataItem>
</Attribute>
</Grid>
</Grid>
</Domain>
</Xdmf>
)");
}

TEST(XdmfSidecar, GivesTheOriginInTheOrderOfTheDimensions) {
  OutputLayout layout(Lattice(0.5, {1, 2, 3}));
  layout.first = {-2, 0, 4};
  layout.last = {-2, 1, 6};
  const std::string text = xdmf_sidecar(layout, std::vector<OutputTime>(1), "fields.hdf");
  EXPECT_THAT(text, HasSubstr(">5.25 2.25 0.25<"));
  EXPECT_THAT(text, HasSubstr("Dimensions=\"3 2 1\""));
}

TEST(XdmfSidecar, SelectsNothingWithoutATimeAxis) {
  OutputLayout layout(Lattice(1, {0, 0, 0}));
  layout.fields = {testing::meta_of("stress", 9, 0)};
  layout.has_mask = true;
  const std::string text = xdmf_sidecar(layout, std::vector<OutputTime>(1), "fields.hdf");
  EXPECT_THAT(text, Not(HasSubstr("HyperSlab")));
  EXPECT_THAT(text, HasSubstr("<Attribute Name=\"stress\" AttributeType=\"Tensor\" Center=\"Node\">\n"
                              "<DataItem Dimensions=\"1 1 1 9\" NumberType=\"Float\" Precision=\"4\" Format=\"HDF\">"
                              "fields.hdf:/VTKHDF/PointData/stress</DataItem>\n</Attribute>"));
  EXPECT_THAT(text, HasSubstr("<Attribute Name=\"mask\" AttributeType=\"Scalar\" Center=\"Node\">\n"
                              "<DataItem Dimensions=\"1 1 1\" NumberType=\"UInt\" Precision=\"4\" Format=\"HDF\">"
                              "fields.hdf:/VTKHDF/PointData/mask</DataItem>\n</Attribute>"));
}

TEST(XdmfSidecar, ShowsSixComponentsAsTwoVectors) {
  OutputLayout layout(Lattice(1, {0, 0, 0}));
  layout.fields = {testing::meta_of("slip_lines", 6, 0)};
  EXPECT_THAT(xdmf_sidecar(layout, std::vector<OutputTime>(1), "fields.hdf"),
              HasSubstr(R"(<Attribute Name="slip_lines_2" AttributeType="Vector" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="1 1 1 3" NumberType="Float" Precision="4">
<DataItem Dimensions="3 4" NumberType="Int" Format="XML">0 0 0 3 1 1 1 1 1 1 1 3</DataItem>
<DataItem Dimensions="1 1 1 6" NumberType="Float" Precision="4" Format="HDF">fields.hdf:/VTKHDF/PointData/slip_lines</DataItem>
</DataItem>
</Attribute>
)"));
}

TEST(XdmfSidecar, EscapesWhatXmlReserves) {
  OutputLayout layout(Lattice(1, {0, 0, 0}));
  layout.fields = {testing::meta_of("a<b&\"c\">", 1, 0)};
  EXPECT_THAT(xdmf_sidecar(layout, std::vector<OutputTime>(1), "fields.hdf"),
              HasSubstr("Name=\"a&lt;b&amp;&quot;c&quot;&gt;\""));
}

}  // namespace
}  // namespace grainvdb::xdmf_sidecar_test
